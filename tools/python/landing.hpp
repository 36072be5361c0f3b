// Shared by the bindings of landings.
#pragma once

#include "landing/judge/checked.hpp"
#include "landing/search/objective.hpp"
#include "tools/python/value.hpp"
#include "tools/report/landing.hpp"

namespace ukemi::python {

/// Changes of a drop; absent: unchanged.
struct DropNumbers {
  std::optional<double> height, forward_speed, pitch, pitch_rate;  ///< [m], [m/s], [rad], [rad/s]
};
/// The drop with these changes. Throws InputError for a number out of range.
landing::Drop dropped(landing::Drop drop, const DropNumbers& numbers);

/// A motion found by a search, with its goal.
struct PlannedMotion : landing::Motion {
  std::string goal;  ///< name of what was minimised
  double value = 0;  ///< of the goal [m/s^2]
};
/// "tolerant peak 190.5 m/s^2".
std::string minimised(const std::string& goal, double value);

/// A landing with its inputs, for the report.
struct Played {
  landing::CheckedLanding checked;  ///< with its sensitivity, if checked
  Actuator actuator;
  double rate = 0;  ///< rows of the trajectory per second [Hz]
};
/// |ddr_0| over time of named landings.
Figure figure(const std::vector<std::pair<std::string, const landing::Landing*>>& landings);
/// A flag for each point, set for the named ones.
std::array<bool, landing::kPoints> points_of(const std::vector<std::string>& names);
/// The goal of a name: peak, tolerant.
landing::Goal goal_of(const std::string& text);

/// A contact with the name of its point.
struct NamedTouch : landing::Touch {
  std::string name;
};
std::vector<NamedTouch> named(const std::vector<landing::Touch>& touches, const tools::PointName& name);

/// Binds peak, end and failure of a run; of(result): the run.
template <class T, class... Options>
void bind_run_end(py::class_<T, Options...>& c, const landing::RunEnd& (*of)(const T&), const char* point) {
  using landing::RunEnd;
  c.def_property_readonly(
       "peak", [of](const T& x) { return of(x).peak; }, "Largest acceleration that counts, f(x) of Eq. 6 [m/s^2].")
      .def_property_readonly(
          "t_peak", [of](const T& x) { return of(x).t_peak; }, "When, from release [s].")
      .def_property_readonly(
          "end", [of](const T& x) { return landing::name(of(x).end); }, "Why the run ended: rest, t_end, failed, ...")
      .def_property_readonly(
          "failure",
          [of, point](const T& x) {
            return landing::no_landing(of(x).end) ? tools::failure_words(of(x), point) : std::string();
          },
          "Why there is no landing; empty where there is one.");
}
/// Binds the peak's error estimate and sensitivity, if checked; of(result): the sensitivity.
template <class T, class... Options>
void bind_sensitivity(py::class_<T, Options...>& c, const landing::Sensitivity& (*of)(const T&)) {
  c.def_property_readonly(
       "error_estimate",
       [of](const T& x) { return of(x).checked ? std::optional(of(x).error_estimate) : std::nullopt; },
       "Estimated relative error of the peak [1], or None where it was not looked at.")
      .def_property_readonly(
          "sensitive", [of](const T& x) { return of(x).checked ? std::optional(of(x).sensitive) : std::nullopt; },
          "Whether the motion stands beside a cliff of the objective, or None where it was not looked at.");
}

template <>
struct Serializer<PlannedMotion>
    : WithBase<PlannedMotion, landing::Motion, &PlannedMotion::goal, &PlannedMotion::value> {};
template <>
struct Serializer<NamedTouch> : WithBase<NamedTouch, landing::Touch, &NamedTouch::name> {};

}  // namespace ukemi::python

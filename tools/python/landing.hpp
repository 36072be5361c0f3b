// What the bindings of landings share.
#pragma once

#include "landing/judge/checked.hpp"
#include "landing/search/objective.hpp"
#include "tools/python/value.hpp"
#include "tools/report/landing.hpp"

namespace ukemi::python {

/// What a dropped() is given; what is absent stays.
struct DropNumbers {
  std::optional<double> height, forward_speed, pitch, pitch_rate;  ///< [m], [m/s], [rad], [rad/s]
};
/// Throws InputError for a number that cannot be.
landing::Drop dropped(landing::Drop drop, const DropNumbers& numbers);

/// A motion that a search found.
struct PlannedMotion : landing::Motion {
  std::string goal;  ///< that was minimised
  double value = 0;  ///< [m/s^2]
};
/// "tolerant peak 190.5 m/s^2".
std::string minimised(const std::string& goal, double value);

/// A landing with what was asked for, for its report.
struct Played {
  landing::CheckedLanding checked;  ///< its sensitivity where it was looked at
  Actuator actuator;
  double rate = 0;  ///< rows of the trajectory a second [Hz]
};
/// |ddr_0| over time of landings by their names.
Figure figure(const std::vector<std::pair<std::string, const landing::Landing*>>& landings);
/// Forbidden points by their names.
std::array<bool, landing::kPoints> points_of(const std::vector<std::string>& names);
/// A goal by its name: peak, tolerant.
landing::Goal goal_of(const std::string& text);

/// A contact with the name of its point.
struct NamedTouch : landing::Touch {
  std::string name;
};
std::vector<NamedTouch> named(const std::vector<landing::Touch>& touches, const tools::PointName& name);

/// What every end of a run tells; `of` is the run of a result.
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
/// How far a peak can be relied on, where it was looked at.
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
struct Carry<PlannedMotion> : OnBase<PlannedMotion, landing::Motion, &PlannedMotion::goal, &PlannedMotion::value> {};
template <>
struct Carry<NamedTouch> : OnBase<NamedTouch, landing::Touch, &NamedTouch::name> {};

}  // namespace ukemi::python

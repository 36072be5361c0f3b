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

/// Binds dropped(...), the same scene with another drop; check(scene) throws InputError for one that cannot be.
template <class Scene, class Check>
void bind_dropped(py::class_<Scene>& c, Check check) {
  c.def(
      "dropped",
      [check](Scene s, std::optional<double> height, std::optional<double> speed, std::optional<double> pitch,
              std::optional<double> pitch_rate) {
        s.drop = dropped(s.drop, {height, speed, pitch, pitch_rate});
        check(s);
        return s;
      },
      py::arg("height") = py::none(), py::arg("forward_speed") = py::none(), py::arg("pitch") = py::none(),
      py::arg("pitch_rate") = py::none(),
      "The same scene with another drop: height [m], forward_speed [m/s], pitch [rad], pitch_rate [rad/s].");
}

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

/// Binds a column of the rows of a landing's trajectory, shown without a copy; address(row): of its number.
template <class T, class Address, class... Options>
void row_property(py::class_<T, Options...>& c, const char* name, const std::string& words, Address address) {
  c.def_property_readonly(
      name,
      [address](const py::object& self) {
        const auto& rows = self.cast<const T&>().checked.landing.trajectory;
        return view(rows.empty() ? nullptr : address(rows.front()), rows.size(), sizeof(rows[0]), self);
      },
      words.c_str());
}

/// A contact with the name of its point.
struct NamedTouch : landing::Touch {
  std::string name;
};
std::vector<NamedTouch> named(const std::vector<landing::Touch>& touches, const tools::PointName& name);

/// Binds what every landing tells; name(x): the names of its points, which messages call `point`.
template <class T, class Name, class... Options>
void bind_checked(py::class_<T, Options...>& c, Name name, const char* point) {
  property(c, "peak", "Largest acceleration that counts, f(x) of Eq. 6 [m/s^2].",
           [](auto& x) { return x.checked.landing.peak; });
  property(c, "t_peak", "When, from release [s].", [](auto& x) { return x.checked.landing.t_peak; });
  property(c, "end", "Why the run ended: rest, t_end, failed, ...",
           [](auto& x) { return landing::name(x.checked.landing.end); });
  property(c, "failure", "Why there is no landing; empty where there is one.", [point](auto& x) {
    const landing::RunEnd& run = x.checked.landing;
    return landing::no_landing(run.end) ? tools::failure_words(run, point) : std::string();
  });
  const auto checked = [](auto member) {
    return [member](const T& x) {
      const landing::Sensitivity& s = x.checked.sensitivity;
      return s.checked ? std::optional(s.*member) : std::nullopt;
    };
  };
  property(c, "error_estimate", "Estimated relative error of the peak [1], or None where it was not looked at.",
           checked(&landing::Sensitivity::error_estimate));
  property(c, "sensitive",
           "Whether the motion stands beside a cliff of the objective, or None where it was not looked at.",
           checked(&landing::Sensitivity::sensitive));
  property(c, "contacts", "Every contact, in the order of the touchdowns.",
           [name](auto& x) { return named(x.checked.landing.touches, name(x)); });
  property(c, "energy_residual", "Mismatch of the energy check over the energy turned over [1].",
           [](auto& x) { return x.checked.landing.energy_residual; });
}

template <>
struct Serializer<PlannedMotion>
    : WithBase<PlannedMotion, landing::Motion, &PlannedMotion::goal, &PlannedMotion::value> {};
template <>
struct Serializer<NamedTouch> : WithBase<NamedTouch, landing::Touch, &NamedTouch::name> {};

}  // namespace ukemi::python

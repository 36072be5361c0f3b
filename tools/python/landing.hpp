// Shared by the bindings of landings, for both kinds of robot.
#pragma once

#include "landing/judge/checked.hpp"
#include "landing/plan/body_plan.hpp"
#include "landing/plan/body_risk.hpp"
#include "landing/plan/checked_body.hpp"
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
/// What was found, and the name of what was minimised or compared.
template <class T>
struct WithGoal {
  T answer;
  std::string goal;
};
/// "tolerant peak 190.5 m/s^2".
std::string minimised(const std::string& goal, double value);

/// A landing with its inputs, for the report.
struct Played {
  landing::CheckedLanding checked;  ///< with its sensitivity, if checked
  Actuator actuator;
  double rate = 0;  ///< rows of the trajectory per second [Hz]
};
/// A landing with the rate of its trajectory [Hz].
struct BodyPlayed {
  landing::CheckedBody checked;
  double rate = 0;
};
/// |ddr_0| over time of named landings.
Figure figure(const std::vector<std::pair<std::string, const landing::Landing*>>& landings);
/// A flag for each point, set for the named ones.
std::array<bool, landing::kPoints> points_of(const std::vector<std::string>& names);
/// The goal of a name: peak, tolerant.
landing::Goal goal_of(const std::string& text);

/// Motions of driven joints by the joint's name.
using JointMotions = std::map<std::string, landing::Motion>;
/// Motions of all joints; those without one are held. Throws InputError for a name that is no driven joint.
landing::BodyMotion motions_of(const landing::BodyScene& scene, const JointMotions& motions);
/// Motions of the driven joints by name, in the robot's order.
py::dict by_joint(const landing::Robot& robot, const landing::BodyMotion& motion);

/// Names of links, joints or contacts.
template <class Named>
std::vector<std::string> names_of(const std::vector<Named>& all) {
  std::vector<std::string> out;
  for (const Named& x : all) out.push_back(x.name);
  return out;
}

/// Dicts of loads by name: kind, of, rating, unit, limit; of a landing also value, t [s] and ratio.
py::dict loads_of_scene(const landing::BodyScene& scene);
py::dict loads_of_landing(const landing::BodyScene& scene, const landing::BodyLanding& landing);

/// Residuals of the outputs that were measured, by name.
std::map<std::string, double> rms_by_output(const tools::FloorFit& fit);

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

void serialize(auto& a, PlannedMotion& x) { serialize_with_base<landing::Motion>(a, x, x.goal, x.value); }
void serialize(auto& a, NamedTouch& x) { serialize_with_base<landing::Touch>(a, x, x.name); }

}  // namespace ukemi::python

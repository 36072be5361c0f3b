// Shared by the bindings of robots of links.
#pragma once

#include "landing/plan/body_plan.hpp"
#include "landing/plan/body_risk.hpp"
#include "landing/plan/checked_body.hpp"
#include "tools/python/landing.hpp"

namespace ukemi::python {

/// Motions of driven joints by the joint's name.
using JointMotions = std::map<std::string, landing::Motion>;
/// Motions of all joints; those without one are held. Throws InputError for a name that is no driven joint.
landing::BodyMotion motions_of(const landing::BodyScene& scene, const JointMotions& motions);
/// Motions of the driven joints by name, in the robot's order.
py::dict by_joint(const landing::Robot& robot, const landing::BodyMotion& motion);

/// Dicts of loads by name: kind, of, rating, unit, limit; of a landing also value, t [s] and ratio.
py::dict loads_of_scene(const landing::BodyScene& scene);
py::dict loads_of_landing(const landing::BodyScene& scene, const landing::BodyLanding& landing);

/// The scene with forbidden contacts and, if `ratings`, the drives' ratings as further limits.
landing::BodyScene with_limits(landing::BodyScene scene, const std::vector<std::string>& forbidden, bool ratings);
/// Plan options from the arguments common to optimize and trade, validated for the scene.
landing::BodyPlanOptions plan_options(const landing::BodyScene& scene, std::uint64_t seed, const std::string& objective,
                                      std::optional<long> evaluations, const std::optional<std::string>& robust,
                                      const std::optional<std::string>& scatter, double inflate, long samples,
                                      int threads);

/// A landing with the rate of its trajectory [Hz].
struct BodyPlayed {
  landing::CheckedBody checked;
  double rate = 0;
};

}  // namespace ukemi::python

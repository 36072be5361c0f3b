// What the bindings of robots of links share.
#pragma once

#include "landing/plan/body_plan.hpp"
#include "landing/plan/body_risk.hpp"
#include "landing/plan/checked_body.hpp"
#include "tools/python/landing.hpp"

namespace ukemi::python {

/// Motions of driven joints by the joint's name.
using JointMotions = std::map<std::string, landing::Motion>;
/// Joints that are not named are held where the scene says. Throws InputError for one that is not driven.
landing::BodyMotion motions_of(const landing::BodyScene& scene, const JointMotions& motions);
/// Those of the driven joints, in the robot's order.
py::dict by_joint(const landing::Robot& robot, const landing::BodyMotion& motion);

/// The loads of a scene by name: kind, of, rating, unit, limit; of a landing also value, t [s] and ratio.
py::dict loads_of_scene(const landing::BodyScene& scene);
py::dict loads_of_landing(const landing::BodyScene& scene, const landing::BodyLanding& landing);

/// The scene with limits beside its stops.
landing::BodyScene limited(landing::BodyScene scene, const std::vector<std::string>& forbidden, bool ratings);
/// What optimize and trade have in common; checked for the scene.
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

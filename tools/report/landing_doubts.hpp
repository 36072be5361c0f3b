// What a reader of a landing must know before its peak is believed, a sentence each.
#pragma once

#include <string>
#include <vector>

#include "landing/judge/checked.hpp"
#include "landing/plan/checked_body.hpp"

namespace ukemi::tools {

/// A drive that has lost the joint.
std::vector<std::string> landing_doubts(const landing::Landing& landing);
/// An actuator that could not follow.
std::vector<std::string> landing_doubts(const landing::Ratings& ratings);
/// A drive that is unstable; `tau_max` may end the growth.
std::vector<std::string> landing_doubts(const std::optional<landing::Instability>& instability, double tau_max);
/// Of a robot of links: drives that are unstable in flight or could not follow, joints that whirl, hinges below the
/// floor (of a landing with a trajectory).
std::vector<std::string> landing_doubts(const landing::BodyScene& scene, const landing::BodyMotion& motion,
                                        const landing::BodyLanding& landing);

/// A demand of a joint beyond its rating.
struct Beyond {
  const landing::Joint* joint;
  double value, rating;
  const char *unit, *at;  ///< "rad/s", "at"; "Nm", "with"
};
std::vector<Beyond> beyond_ratings(const landing::BodyScene& scene, const landing::BodyMotion& motion,
                                   const landing::BodyLanding& landing);
/// When landing motions start, from release [s].
double expected_start(const landing::BodyScene& scene, const landing::BodyLanding& landing);

}  // namespace ukemi::tools

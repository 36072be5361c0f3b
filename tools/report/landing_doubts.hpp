// Reasons to doubt the peak of a landing, a sentence each.
#pragma once

#include <string>
#include <vector>

#include "landing/judge/checked.hpp"
#include "landing/plan/checked_body.hpp"

namespace ukemi::tools {

/// The drive has lost the joint.
std::vector<std::string> landing_doubts(const landing::Landing& landing);
/// The motion exceeds the actuator's ratings.
std::vector<std::string> landing_doubts(const landing::Ratings& ratings);
/// The drive is unstable; `tau_max` [Nm] may bound the growth.
std::vector<std::string> landing_doubts(const std::optional<landing::Instability>& instability, double tau_max);
/// Robot of links: drives that are unstable in flight or exceed their ratings, joints that turn over, joints below the
/// floor (needs a trajectory).
std::vector<std::string> landing_doubts(const landing::BodyScene& scene, const landing::BodyMotion& motion,
                                        const landing::BodyLanding& landing);

/// A demand of a joint that exceeds its rating.
struct ExceededRating {
  const landing::Joint* joint;
  double value, rating;
  const char *unit, *preposition;  ///< "rad/s", "at"; "Nm", "with"
};
std::vector<ExceededRating> exceeded_ratings(const landing::BodyScene& scene, const landing::BodyMotion& motion,
                                             const landing::BodyLanding& landing);
/// Expected start of landing motions, from release [s]: first touchdown + detection delay.
double expected_start(const landing::BodyScene& scene, const landing::BodyLanding& landing);

}  // namespace ukemi::tools

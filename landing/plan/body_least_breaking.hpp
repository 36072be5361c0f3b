// Where no motion of a robot of links keeps the ratings of its drives: the one that breaks them least.
#pragma once

#include <optional>

#include "landing/plan/body_plan.hpp"

namespace ukemi::landing {

struct BodyLeastBreaking {
  BodyMotion motion;
  int joint;                                        ///< of Robot::joints, whose rating it breaks most
  Load::Kind kind;                                  ///< kMotorSpeed or kMotorTorque
  double demand, limit;                             ///< on it, and what the rating allows [rad/s, Nm]
  double excess() const { return demand / limit; }  ///< [1]
};

/// Of a scene whose limits are the ratings, see respect_ratings: the ratings as loads, of which a small search makes
/// the largest part small in the execution box. The other limits stay: absent where they cannot be kept, or where it is
/// one of them that no motion keeps. Of the options accuracy, seed, threads and monitor count.
[[nodiscard]] std::optional<BodyLeastBreaking> least_breaking(const BodyScene& scene, const BodyPlanOptions& options);

}  // namespace ukemi::landing

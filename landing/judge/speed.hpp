// The best motions as functions of the motor's ratings.
#pragma once

#include <vector>

#include "common/actuator.hpp"
#include "landing/search/optimize.hpp"

namespace ukemi::landing {

/// The best motions within the ratings `speed` and `torque` of a motor, everywhere in the execution box; `speed` limits
/// the reference too.
struct RatedPlan {
  double speed, torque;      ///< [rad/s], [Nm]
  Optimum lowest, tolerant;  ///< by the peak, by the tolerant peak
};

struct RatingOptions {
  std::vector<double> speeds, torques;  ///< above 0, increasing
  OptimizeOptions search;               ///< of each search; its goal and limits of the motor are overwritten
};

/// Every torque at every speed, the torque fastest. A weaker motor's plan is taken over where it is better, so that no
/// plan is worse than that of a weaker motor.
[[nodiscard]] std::vector<RatedPlan> rated_plans(const Scene& scene, const Actuator& actuator,
                                                 const RatingOptions& options);

}  // namespace ukemi::landing

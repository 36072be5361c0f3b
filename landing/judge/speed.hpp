// What speed buys: the best motions against the motor's ratings.
#pragma once

#include <vector>

#include "common/actuator.hpp"
#include "landing/search/optimize.hpp"

namespace ukemi::landing {

/// The best motions of a motor that turns at most at `speed` and pulls at most with `torque`, everywhere in the
/// execution box; the reference is no faster than the motor.
struct RatedPlan {
  double speed, torque;      ///< [rad/s], [Nm]
  Optimum lowest, tolerant;  ///< by the peak, by the tolerant peak
};

struct RatingOptions {
  std::vector<double> speeds, torques;  ///< above 0, rising
  OptimizeOptions search;               ///< each search's; its goal and limits of the motor are set here
};

/// Every torque at every speed, speeds first. A motion that a lesser motor can play is one of a better motor's: none of
/// them is worse.
[[nodiscard]] std::vector<RatedPlan> rated_plans(const Scene& scene, const Actuator& actuator,
                                                 const RatingOptions& options);

}  // namespace ukemi::landing

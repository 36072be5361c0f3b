// Where no motion keeps the actuator's ratings: the one that breaks them least.
#pragma once

#include <optional>

#include "landing/model/motion_space.hpp"
#include "landing/search/optimize.hpp"

namespace ukemi::landing {

struct LeastBreaking {
  Motion motion{};
  const char* rating = "";  ///< that it breaks most: "reference_rate", "motor_speed" or "motor_torque"
  const char* unit = "";    ///< "rad/s" or "Nm"
  double demand = 0;        ///< on it [unit]
  double limit = 0;         ///< that the rating allows [unit]
  double excess() const { return demand / limit; }  ///< [1]
};

/// The least excess of some 400 motions that a small search plays: over the execution box, or, under scatter, over a
/// few of the drops that are searched on, in the share of them that the measure asks for (Measure::share). The other
/// limits are kept: absent where they cannot be. The same whatever the number of threads.
[[nodiscard]] std::optional<LeastBreaking> least_breaking(const Scene& scene, const MotionSpace& space,
                                                          const OptimizeOptions& options);

}  // namespace ukemi::landing

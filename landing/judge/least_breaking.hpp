// The motion that exceeds the actuator's ratings least, where none keeps them.
#pragma once

#include <optional>

#include "landing/model/motion_space.hpp"
#include "landing/search/optimize.hpp"

namespace ukemi::landing {

struct LeastBreaking {
  Motion motion{};
  const char* rating = "";  ///< exceeded most: "reference_rate", "motor_speed" or "motor_torque"
  const char* unit = "";    ///< "rad/s" or "Nm"
  double demand = 0;        ///< [unit]
  double limit = 0;         ///< of the rating [unit]
  double excess() const { return demand / limit; }  ///< [1]
};

/// The least excess of some 400 motions of a small search: over the execution box, or under scatter in Measure::share
/// of a few of the search's drops. The other limits are kept: absent where they cannot be. The number of threads has no
/// influence.
[[nodiscard]] std::optional<LeastBreaking> least_breaking(const Scene& scene, const MotionSpace& space,
                                                          const OptimizeOptions& options);

}  // namespace ukemi::landing

// Degrees, for what people read and write; everything else is in radians.
#pragma once

#include <numbers>

namespace ukemi {

inline constexpr double kDegree = std::numbers::pi / 180;   ///< a degree [rad]
inline constexpr double kDegrees = 180 / std::numbers::pi;  ///< a radian [deg]

}  // namespace ukemi

#include "common/degrees_doubt.hpp"

#include <fmt/format.h>

#include <cmath>

#include "common/degrees.hpp"

namespace ukemi {

std::string radians_doubt(const std::string& what, double degrees) {
  if (degrees == 0 || !(std::abs(degrees) < 2)) return "";
  return fmt::format("{}: {:g}: degrees, not radians ({:g} rad would be {:.4g})", what, degrees, degrees,
                     degrees * kDegrees);
}

std::string radians_doubt(const std::string& what, const std::array<double, 2>& degrees) {
  constexpr double kPi = 180 / kDegrees;
  if (!(std::abs(degrees[0]) <= kPi && std::abs(degrees[1]) <= kPi)) return "";
  return fmt::format("{0}: [{1:g}, {2:g}]: degrees, not radians ([{1:g}, {2:g}] rad would be [{3:.4g}, {4:.4g}])", what,
                     degrees[0], degrees[1], degrees[0] * kDegrees, degrees[1] * kDegrees);
}

}  // namespace ukemi

// Angles in degrees that were perhaps meant in radians.
#pragma once

#include <array>
#include <string>

namespace ukemi {

/// "WHAT: -0.78: degrees, not radians (-0.78 rad would be -44.69)", for an angle [deg] of magnitude
/// below 2 other than 0; else empty.
std::string radians_doubt(const std::string& what, double degrees);
/// Such a message for a range [deg] whose ends are both within pi; else empty.
std::string radians_doubt(const std::string& what, const std::array<double, 2>& degrees);

}  // namespace ukemi

// Angles in degrees that were perhaps meant in radians.
#pragma once

#include <array>
#include <string>

namespace ukemi {

/// "WHAT: -0.78: degrees, not radians (-0.78 rad would be -44.69)", of an angle [deg] within 2 deg and not 0; empty: it
/// is no such angle.
std::string radians_doubt(const std::string& what, double degrees);
/// The same of a range whose ends are both within pi.
std::string radians_doubt(const std::string& what, const std::array<double, 2>& degrees);

}  // namespace ukemi

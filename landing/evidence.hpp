// What a motion is worth beside its peak: how wide its basin is, and what small deviations do to it.
#pragma once

#include <array>

#include "landing/robust.hpp"

namespace ukemi::landing {

/// How the peak holds when one thing at a time is not as planned.
struct Evidence {
  double peak = 0;  ///< of the motion [m/s^2]
  /// How far phi_I, phi_F [rad] and the duration [s] may move down and up before the peak rises by kRise; at most to
  /// the end of the search range.
  std::array<std::array<double, 2>, 3> width{};
  double one_degree = 0;        ///< worst peak with both angles off by up to 1 deg (corners and faces) [m/s^2]
  double ten_milliseconds = 0;  ///< with the duration off by 10 ms either way
  double one_centimetre = 0;    ///< with the drop's height off by 1 cm either way
  TolerantPeak tolerant;        ///< within the scene's execution tolerance
  static constexpr double kRise = 0.05;
};

/// Works it out with landings at `accuracy`. A width is found on a geometric grid from 1e-7 of the range up and then
/// between its last good and first bad point, so it is that of the part that hangs together with the motion.
[[nodiscard]] Evidence evidence(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                                double accuracy, int tolerance_samples, std::uint64_t seed, int threads);

}  // namespace ukemi::landing

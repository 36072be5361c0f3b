// What a motion is worth when it is played inexactly.
#pragma once

#include <cstdint>
#include <vector>

#include "landing/model/motion_space.hpp"
#include "landing/run/simulate.hpp"

namespace ukemi::landing {

/// Worst peaks within the scene's execution tolerance around a motion x.
struct TolerantPeak {
  double peak = 0;     ///< f(x) [m/s^2]
  double value = 0;    ///< the largest f over x, six face centres and eight corners of the box x + (i da, j da, k dt)
  Motion worst{};      ///< where
  double sampled = 0;  ///< the largest f on random points inside the box; may exceed `value`
  int samples = 0;
  std::array<int, kPoints> touching{}, samples_touching{};  ///< in how many of the fifteen, and of the samples, a point
                                                            ///< touches
  bool failed = false;                                      ///< some landing in the box could not be followed
  bool complete = true;  ///< false: options.over ended it before all was played, and `value` is a lower bound
};

/// Evaluates the motions of the tolerant peak (kExecutionPoints), and random points inside for the check (in lanes at
/// 1e-6; the worst by the scalar path), on `threads` threads: `samples` of them, or as many as kCheckWork allows where
/// every landing is long.
[[nodiscard]] TolerantPeak tolerant_peak(const Scene& scene, const MotionSpace& space, const Play& play,
                                         const SimulateOptions& options, int samples, std::uint64_t seed, int threads);
/// The same of a motion of Eq. 6.
[[nodiscard]] TolerantPeak tolerant_peak(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                                         const SimulateOptions& options, int samples, std::uint64_t seed, int threads);

}  // namespace ukemi::landing

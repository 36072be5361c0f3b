// The worst peak of a motion within the execution tolerance.
#pragma once

#include <cstdint>

#include "landing/model/motion_space.hpp"
#include "landing/run/simulate.hpp"
#include "landing/search/goal.hpp"

namespace ukemi::landing {

/// Evaluates the motions of the tolerant peak (kExecutionPoints), and as a check `samples` random points inside the box
/// (in lanes at 1e-6, the worst again in the scalar path), or as many as kCheckWork allows where landings are long.
[[nodiscard]] TolerantPeak tolerant_peak(const Scene& scene, const MotionSpace& space, const DrivenMotion& play,
                                         const SimulateOptions& options, int samples, std::uint64_t seed, int threads);
/// The tolerant peak of a motion of Eq. 6.
[[nodiscard]] TolerantPeak tolerant_peak(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                                         const SimulateOptions& options, int samples, std::uint64_t seed, int threads);

}  // namespace ukemi::landing

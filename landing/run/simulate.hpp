// The accuracy of a landing's steps.
#pragma once

#include <algorithm>

#include "common/integrate/hybrid.hpp"
#include "common/integrate/method.hpp"
#include "landing/model/motion.hpp"
#include "landing/run/landing.hpp"

namespace ukemi::landing {

using integrate::Method;

/// At this accuracy and looser the lower order is faster; see tools/docs/benchmarks_landings.md.
inline constexpr double kLowOrder = 1e-7;

/// Whether dry friction on the output falls with speed. It then changes within stribeck_speed, which may take only
/// microseconds, so that looser steps miss a peak of |ddr_0|. The scalar path simulates these landings at 1e-7 or
/// finer; lanes hand them over. Tests: test/property/batch.cpp, stability.cpp.
inline bool needs_fine_steps(const SeaParameters<double>& sea) {
  return sea.output_friction != 0 && sea.breakaway != 0;
}
/// The accuracy of the steps of a landing for a requested one.
inline double step_accuracy(double requested, const SeaParameters<double>& sea) {
  constexpr double kFine = 1e-7;
  return needs_fine_steps(sea) ? std::min(requested, kFine) : requested;
}

}  // namespace ukemi::landing

// The accuracy of a landing's steps, and a landing with one given integrator.
#pragma once

#include <algorithm>

#include "common/integrate/hybrid.hpp"
#include "common/integrate/method.hpp"
#include "landing/model/motion.hpp"
#include "landing/model/two_link.hpp"
#include "landing/run/landing.hpp"

namespace ukemi::landing {

using integrate::Method;

/// From this accuracy up the lower order takes less time; see the table of tools/docs/benchmarks_landings.md.
inline constexpr double kLowOrder = 1e-7;

/// Whether dry friction on the output falls with speed. Where the joint turns it then changes within stribeck_speed,
/// which may be some microseconds, so that looser steps pass over a peak of |ddr_0| there. The scalar path follows
/// these landings at 1e-7 or finer; lanes hand them over. Tests: test/property/batch.cpp, stability.cpp.
inline bool needs_fine_steps(const SeaParameters<double>& sea) {
  return sea.output_friction != 0 && sea.breakaway != 0;
}
/// The accuracy that the steps of a landing keep where `asked` is asked.
inline double step_accuracy(double asked, const SeaParameters<double>& sea) {
  constexpr double kFine = 1e-7;
  return needs_fine_steps(sea) ? std::min(asked, kFine) : asked;
}

/// `peak_acceleration` with a single method, to compare integrators; one kernel for every scene.
void follow_with_method(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                        const SimulateOptions& options, LandingPeak& out);

}  // namespace ukemi::landing

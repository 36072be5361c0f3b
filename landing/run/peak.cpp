// The fast path: nothing but the peak.
#include "landing/run/kernels.hpp"

namespace ukemi::landing {

LandingPeak peak_acceleration(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                              const SimulateOptions& options) {
  LandingPeak out;
  if (options.method == Method::kAuto)
    dispatch<false>(scene, sea, motion, options, out, nullptr, 0);
  else
    follow_with_method(scene, sea, motion, options, out);
  return out;
}

}  // namespace ukemi::landing

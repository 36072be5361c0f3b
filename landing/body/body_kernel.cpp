// Compiled once for each kernel of peaks, UKEMI_KERNEL (see CMakeLists.txt).
#include "landing/body/body_kernel.hpp"

#include "common/integrate/automatic.hpp"
#include "landing/body/body_follow.hpp"

namespace ukemi::landing {

template <Capacity kSize>
BodyLanding peak_in_kernel(const BodyScene& scene, const BodyMotion& motion, const SimulateOptions& options) {
  BodyLanding out;
  if (options.accuracy >= kLowOrder)
    BodyFollower<integrate::LowOrder, kSize, false>(scene, motion, options, out, 0).follow();
  else
    BodyFollower<integrate::HighOrder, kSize, false>(scene, motion, options, out, 0).follow();
  return out;
}
template BodyLanding peak_in_kernel<UKEMI_KERNEL>(const BodyScene&, const BodyMotion&, const SimulateOptions&);

}  // namespace ukemi::landing

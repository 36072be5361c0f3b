// Compiled once for each kernel, UKEMI_KERNEL (see CMakeLists.txt).
#include "landing/body/body_kernel.hpp"

#include "common/integrate/tableaus.hpp"
#include "landing/body/body_follow.hpp"

namespace ukemi::landing {

template <Capacity kSize>
BodyLanding peak_in_kernel(const BodyScene& scene, const BodyMotion& motion, const SimulateOptions& options) {
  BodyLanding out;
  BodyFollower<integrate::DormandPrince54, kSize, false>(scene, motion, options, out, 0).follow();
  return out;
}
template BodyLanding peak_in_kernel<UKEMI_KERNEL>(const BodyScene&, const BodyMotion&, const SimulateOptions&);

}  // namespace ukemi::landing

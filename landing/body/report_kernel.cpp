// Compiled once for each kernel of reports, UKEMI_KERNEL (see CMakeLists.txt).
#include "common/integrate/automatic.hpp"
#include "landing/body/body_follow.hpp"
#include "landing/body/body_kernel.hpp"

namespace ukemi::landing {

template <Capacity kSize>
BodyLanding report_in_kernel(const BodyScene& scene, const BodyMotion& motion, const SimulateOptions& options,
                             double rate) {
  BodyLanding out;
  BodyFollower<integrate::HighOrder, kSize, true>(scene, motion, options, out, rate).follow();
  return out;
}
template BodyLanding report_in_kernel<UKEMI_KERNEL>(const BodyScene&, const BodyMotion&, const SimulateOptions&,
                                                    double);

}  // namespace ukemi::landing

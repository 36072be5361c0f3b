// Compiled once for each kernel, UKEMI_KERNEL (see CMakeLists.txt).
#include "landing/derivatives/gradient_kernel.hpp"

#include "landing/derivatives/differentiated_body.hpp"
#include "landing/derivatives/peak_observer.hpp"

namespace ukemi::landing {

template <Capacity kSize>
BodyGradients gradients_in_kernel(const BodyScene& scene, const BodyMotion& motion,
                                  std::span<const BodyParameter> parameters, const SimulateOptions& options, int most) {
  using Differentiated = DifferentiatedBody<kAtOnce, kSize>;
  Differentiated landing(scene, motion, parameters, options);
  PeakObserver<Differentiated> observer(most);
  const DifferentiatedOutcome outcome = landing.run(observer);
  BodyGradients out{.peaks = {}, .t_end = outcome.t_end, .end = outcome.end, .status = outcome.status};
  for (const auto& p : observer.peaks)
    out.peaks.push_back(
        {p.t, p.value, (p.d.array() / landing.unit()).matrix().head(Eigen::Index(parameters.size())), p.kind});
  return out;
}
template BodyGradients gradients_in_kernel<UKEMI_KERNEL>(const BodyScene&, const BodyMotion&,
                                                         std::span<const BodyParameter>, const SimulateOptions&, int);

}  // namespace ukemi::landing

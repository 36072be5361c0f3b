// Compiled once for each kernel, UKEMI_KERNEL, with UKEMI_PARAMETERS derivatives (see CMakeLists.txt).
#include "landing/derivatives/gradient_kernel.hpp"

#include "landing/derivatives/differentiated_body.hpp"
#include "landing/derivatives/load_peaks.hpp"

namespace ukemi::landing {

namespace {

/// Peaks with derivatives by the parameters, from those by scaled ones.
template <class Peaks, class Unit>
std::vector<BodyPeakGradient> in_units(const Peaks& peaks, const Unit& unit, std::size_t parameters) {
  std::vector<BodyPeakGradient> out;
  for (const auto& p : peaks)
    out.push_back({p.t, p.value, (p.d.array() / unit).matrix().head(Eigen::Index(parameters)), p.kind, p.contact});
  return out;
}

}  // namespace

template <Capacity kSize, int P>
BodyGradients gradients_in_kernel(const BodyScene& scene, const BodyMotion& motion,
                                  std::span<const BodyParameter> parameters, const SimulateOptions& options,
                                  int max_peaks) {
  using Differentiated = DifferentiatedBody<P, kSize>;
  Differentiated landing(scene, motion, parameters, options);
  const auto outcome_of = [](const DifferentiatedOutcome& o) {
    return BodyGradients{.t_end = o.t_end, .end = o.end, .status = o.status, .work = o.work};
  };
  const std::size_t n = parameters.size();
  if (scene.loads.empty()) {
    PeakObserver<Differentiated> observer(max_peaks);
    BodyGradients out = outcome_of(landing.run(observer));
    out.peaks = in_units(observer.peaks, landing.unit(), n);
    return out;
  }
  LoadPeaks<Differentiated> observer(scene, max_peaks);
  BodyGradients out = outcome_of(landing.run(observer));
  out.peaks = in_units(observer.peak.peaks, landing.unit(), n);
  for (std::size_t i = 0; i < scene.loads.size(); ++i)
    out.loads.push_back(in_units(observer.peaks(i), landing.unit(), n));
  return out;
}
template BodyGradients gradients_in_kernel<UKEMI_KERNEL, UKEMI_PARAMETERS>(const BodyScene&, const BodyMotion&,
                                                                           std::span<const BodyParameter>,
                                                                           const SimulateOptions&, int);

}  // namespace ukemi::landing

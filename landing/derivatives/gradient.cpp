#include "landing/derivatives/gradient.hpp"

#include "landing/derivatives/differentiated_landing.hpp"
#include "landing/derivatives/peak_observer.hpp"

namespace ukemi::landing {

namespace {

template <int P, LandingTerms kTerms>
PeakGradients<P> peaks_of(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                          const SimulateOptions& options, int max_peaks) {
  DifferentiatedLanding<P, kTerms> landing(scene, sea, motion, options, Parameter::kPhiI);
  PeakObserver<DifferentiatedLanding<P, kTerms>> observer(max_peaks);
  const auto outcome = landing.run(observer);
  for (auto& p : observer.peaks) p.d.array() /= landing.unit();
  return {std::move(observer.peaks), outcome.t_end, outcome.end, outcome.status, outcome.work};
}

template <int P>
PeakGradients<P> differentiate(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                               const SimulateOptions& options, int max_peaks) {
  validate(scene, sea, motion), options.validate();
  return with_terms(sea,
                    [&]<LandingTerms kTerms>() { return peaks_of<P, kTerms>(scene, sea, motion, options, max_peaks); });
}

}  // namespace

PeakGradients<kQuinticParameters> quintic_peaks(const Scene& scene, const SeaParameters<double>& sea,
                                                const Motion& motion, const SimulateOptions& options, int max_peaks) {
  return differentiate<kQuinticParameters>(scene, sea, motion, options, max_peaks);
}

PeakGradients<kMotionParameters> motion_peaks(const Scene& scene, const SeaParameters<double>& sea,
                                              const Motion& motion, const SimulateOptions& options, int max_peaks) {
  return differentiate<kMotionParameters>(scene, sea, motion, options, max_peaks);
}

PeakGradients<kParameters> all_gradients(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                                         const SimulateOptions& options, int max_peaks) {
  return differentiate<kParameters>(scene, sea, motion, options, max_peaks);
}

}  // namespace ukemi::landing

// Stubs of NLopt, of derivatives and of single integrators, which the page lacks: its plans are found by our own
// derivative-free searches.
#include <stdexcept>

#include "landing/body/body_kernel.hpp"
#include "landing/derivatives/body_gradient.hpp"
#include "landing/derivatives/gradient.hpp"
#include "landing/search/nlopt_solver.hpp"

namespace ukemi::landing {

namespace {

[[noreturn]] void absent() { throw std::logic_error("the page does not have it"); }

}  // namespace

const std::vector<std::string>& nlopt_names() {
  static const std::vector<std::string> none;
  return none;
}
NloptResult minimize(const std::string&, const NloptProblem&, const NloptStop&, std::uint64_t) { absent(); }
/// Evaluates no point; plans are then refined by sampling a narrow distribution.
int minimize_epigraph(const EpigraphProblem&, double) { return 0; }

PeakGradients<kQuinticParameters> quintic_peaks(const Scene&, const SeaParameters<double>&, const Motion&,
                                                const SimulateOptions&, int) {
  absent();
}
PeakGradients<kMotionParameters> motion_peaks(const Scene&, const SeaParameters<double>&, const Motion&,
                                              const SimulateOptions&, int) {
  absent();
}
PeakGradients<kParameters> all_gradients(const Scene&, const SeaParameters<double>&, const Motion&,
                                         const SimulateOptions&, int) {
  absent();
}
BodyLanding peak_by_method(const BodyScene&, const BodyMotion&, const SimulateOptions&) { absent(); }
BodyGradients gradients(const BodyScene&, const BodyMotion&, std::span<const BodyParameter>, const SimulateOptions&,
                        int) {
  absent();
}

}  // namespace ukemi::landing

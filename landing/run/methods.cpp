// Landings by a single integrator, for comparison with `auto`: compiled for the kernel that holds every term.
#include "common/integrate/rosenbrock.hpp"
#include "common/integrate/semi_implicit_euler.hpp"
#include "landing/run/follow.hpp"

namespace ukemi::landing {

void follow_with_method(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                        const SimulateOptions& options, LandingPeak& out) {
  const auto with = [&]<class M>() {
    if (is_late(sea))
      Follower<M, kLateTerms, false>(scene, sea, motion, options, out, nullptr, 0).follow();
    else
      Follower<M, kExtendedTerms, false>(scene, sea, motion, options, out, nullptr, 0).follow();
  };
  switch (options.method) {
    case Method::kSemiImplicitEuler:
      return with.template operator()<integrate::SemiImplicitEuler>();
    case Method::kRungeKutta4:
      return with.template operator()<integrate::RungeKutta4>();
    case Method::kRodas5P:
      return with.template operator()<integrate::Rodas5P>();
    case Method::kDormandPrince54:
      return with.template operator()<integrate::DormandPrince54>();
    case Method::kAuto:
    case Method::kDormandPrince853:
      return with.template operator()<integrate::DormandPrince853>();
  }
}

}  // namespace ukemi::landing

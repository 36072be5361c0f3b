// Landings of the paper's robot by a single integrator, for comparison with `auto`.
#include "common/integrate/rosenbrock.hpp"
#include "common/integrate/semi_implicit_euler.hpp"
#include "landing/body/body_follow.hpp"
#include "landing/body/body_kernel.hpp"

namespace ukemi::landing {

BodyLanding peak_by_method(const BodyScene& scene, const BodyMotion& motion, const SimulateOptions& options) {
  const auto with = [&]<class M>() {
    return in_kernel<kPair, kLateLeg>(scene.robot, [&]<Capacity kSize>() {
      BodyLanding out;
      BodyFollower<M, kSize, false>(scene, motion, options, out, 0).follow();
      return out;
    });
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
      break;
  }
  return with.template operator()<integrate::DormandPrince853>();
}

}  // namespace ukemi::landing

// The methods besides that of fits, compiled for the kernel with every term.
#include "common/error.hpp"
#include "common/integrate/automatic.hpp"
#include "common/integrate/semi_implicit_euler.hpp"
#include "identify/rollout/roll.hpp"

namespace ukemi::identify {

template <class T>
RolloutStatus rollout_with_method(const Rig& rig, const SeaParameters<T>& sea, const Nuisance<T>& nuisance,
                                  const PreparedTrial& trial, const RolloutOptions& options, std::vector<T>& phi,
                                  std::vector<T>& phi_m, std::vector<T>* torque) {
  using integrate::DormandPrince54, integrate::DormandPrince853, integrate::Rodas5P;
  using Linear = RolloutOptions::Linear;
  const auto run = [&]<class M, bool kLate = false, Linear kLinear = Linear::kIntegrated>() {
    return TrialRollout<M, SeaTerms{true, true, kLate}, T, kLinear>(rig, sea, nuisance, trial, options, phi, phi_m,
                                                                    torque)
        .run();
  };
  const bool late = !trial.trial->rig_or(rig).drive.known_command() && is_late(sea);
  if constexpr (std::is_same_v<T, double>) {  // implicit methods have no derivatives
    using Automatic = integrate::Automatic<DormandPrince853, Rodas5P>;
    if (options.method == Method::kAuto)
      return late ? run.template operator()<Automatic, true, Linear::kExact>()
                  : run.template operator()<Automatic, false, Linear::kExact>();
  }
  if (late)
    throw InputError(std::string("method: ") + integrate::name(*options.method) +
                     ": of a drive without delay and filter alone");
  if constexpr (std::is_same_v<T, double>)
    if (options.method == Method::kRodas5P) return run.template operator()<Rodas5P>();
  if (options.method == Method::kSemiImplicitEuler) return run.template operator()<integrate::SemiImplicitEuler>();
  if (options.method == Method::kRungeKutta4) return run.template operator()<integrate::RungeKutta4>();
  if (options.method == Method::kDormandPrince54) return run.template operator()<DormandPrince54>();
  return run.template operator()<DormandPrince853>();
}

template RolloutStatus rollout_with_method(const Rig&, const SeaParameters<double>&, const Nuisance<double>&,
                                           const PreparedTrial&, const RolloutOptions&, std::vector<double>&,
                                           std::vector<double>&, std::vector<double>*);
using Small = ceres::Jet<double, kSmallJet>;
template RolloutStatus rollout_with_method(const Rig&, const SeaParameters<Small>&, const Nuisance<Small>&,
                                           const PreparedTrial&, const RolloutOptions&, std::vector<Small>&,
                                           std::vector<Small>&, std::vector<Small>*);

}  // namespace ukemi::identify

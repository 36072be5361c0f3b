// Selects the kernel of a trial. Included by the files that compile them, one for each scalar: rollout.cpp,
// rollout_small.cpp, rollout_large.cpp.
#pragma once

#include "identify/rollout/roll.hpp"

namespace ukemi::identify {

template <class T>
RolloutStatus rollout(const Rig& common, const SeaParameters<T>& actuator, const Nuisance<T>& nuisance,
                      const PreparedTrial& trial, const RolloutOptions& options, std::vector<T>& phi,
                      std::vector<T>& phi_m, std::vector<T>* torque) {
  options.validate();
  const Rig& rig = trial.trial->rig_or(common);
  const SeaParameters<T> sea = trial.trial->rig ? rig.mounted(actuator) : actuator;
  const bool late = !rig.drive.known_command() && is_late(sea);
  const bool extended = late || rig.drive.kind != Drive::Kind::kGains || present(sea.friction) ||
                        present(sea.viscous) || present(sea.output_friction) || present(sea.output_viscous) ||
                        present(sea.k_sea_cubic) || present(sea.spring_loss) || rig.gravity.moment != 0 ||
                        sea.feedback == Feedback::kMotor;
  const auto run = [&]<class Method, SeaTerms kTerms>() {
    return TrialRollout<Method, kTerms, T>(rig, sea, nuisance, trial, options, phi, phi_m, torque).run();
  };
  // Always with the torque limit: its guards are cheap, and an absent limit is infinite. Without friction and
  // stiffening only hits are integrated, from sample to sample: steps too short for order 8.
  if constexpr (kDerivatives<T> <= kSmallJet) {
    if (options.method) return rollout_with_method(rig, sea, nuisance, trial, options, phi, phi_m, torque);
    if (!extended) return run.template operator()<integrate::DormandPrince54, SeaTerms{true, false}>();
  }
  if (late) return run.template operator()<integrate::DormandPrince853, SeaTerms{true, true, true}>();
  return run.template operator()<integrate::DormandPrince853, SeaTerms{true, true}>();
}

}  // namespace ukemi::identify

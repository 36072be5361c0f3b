// Which kernel a trial runs. Included by the files that compile them, a scalar each: rollout.cpp, rollout_small.cpp,
// rollout_large.cpp.
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
  const bool late = !rig.drive.by_command() && is_late(sea);
  const bool extended = late || rig.drive.kind != Drive::Kind::kGains || present(sea.friction) ||
                        present(sea.viscous) || present(sea.output_friction) || present(sea.output_viscous) ||
                        present(sea.k_sea_cubic) || present(sea.spring_loss) || rig.gravity.moment != 0 ||
                        sea.feedback == Feedback::kMotor;
  if constexpr (kDerivatives<T> <= kSmallJet)
    if (options.method) return roll_with_method(rig, sea, nuisance, trial, options, phi, phi_m, torque);
  // The limit's guards cost next to nothing, and a limit that is absent is infinite. Without friction and stiffening
  // only hits are integrated, from sample to sample: no place for long steps.
  if constexpr (kDerivatives<T> <= kSmallJet)
    if (!extended)
      return Roll<integrate::DormandPrince54, SeaTerms{true, false}, T>(rig, sea, nuisance, trial, options, phi, phi_m,
                                                                        torque)
          .run();
  if (late)
    return Roll<integrate::DormandPrince853, SeaTerms{true, true, true}, T>(rig, sea, nuisance, trial, options, phi,
                                                                            phi_m, torque)
        .run();
  return Roll<integrate::DormandPrince853, SeaTerms{true, true}, T>(rig, sea, nuisance, trial, options, phi, phi_m,
                                                                    torque)
      .run();
}

}  // namespace ukemi::identify

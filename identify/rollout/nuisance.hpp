// What differs from trial to trial, and how a trial's rollout ends.
#pragma once

namespace ukemi::identify {

/// What may differ from trial to trial besides the hit; each may be a nuisance of the fit. A trial starts at rest at
/// its reference, and is measured as it is, but for these.
template <class T>
struct Nuisance {
  T angle{0};           ///< at the start; moves phi_1 and phi_m together: the spring starts relaxed [rad]
  T rate{0};            ///< dphi_1 at the start [rad/s]
  T force_gain{1};      ///< F_e = force_gain F_log(t - time_shift) + force_bias
  T force_bias{0};      ///< [N]
  T time_shift{0};      ///< of the force's log, positive: the hit came later than logged [s]
  T encoder_gain{1};    ///< phi as measured = encoder_gain phi_1 + encoder_offset
  T encoder_offset{0};  ///< [rad]
  T torque_gain{1};     ///< a logged torque = torque_gain tau_SEA + torque_bias
  T torque_bias{0};     ///< [Nm]
};

/// Of a rollout, the longest step [s].
inline constexpr double kLongestStep = 0.05;
/// Beyond this |phi_1| from the start the trial has escaped (turns past any useful angle) [rad].
inline constexpr double kEscape = 3.14159265358979;

enum class RolloutStatus { kDone, kEscaped, kDiverged };
const char* name(RolloutStatus status);

}  // namespace ukemi::identify

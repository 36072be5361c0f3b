// Nuisance terms of a trial, and the status of its rollout.
#pragma once

#include <numbers>

namespace ukemi::identify {

/// What may differ between trials besides the excitation; each may be a nuisance term of the fit. With the defaults a
/// trial starts at rest at its reference, and its sensors are exact.
template <class T>
struct Nuisance {
  T angle{0};           ///< offset of phi_1 and phi_m at the start: the spring starts relaxed [rad]
  T rate{0};            ///< dphi_1 at the start [rad/s]
  T force_gain{1};      ///< F_e = force_gain F_log(t - time_shift) + force_bias
  T force_bias{0};      ///< [N]
  T time_shift{0};      ///< of the force's log; > 0: the hit came later than logged [s]
  T encoder_gain{1};    ///< phi as measured = encoder_gain phi_1 + encoder_offset
  T encoder_offset{0};  ///< [rad]
  T torque_gain{1};     ///< a logged torque = torque_gain tau_SEA + torque_bias
  T torque_bias{0};     ///< [Nm]
};

/// Longest step of a rollout [s].
inline constexpr double kLongestStep = 0.05;
/// Distance of phi_1 from the start beyond which the trial has escaped (no useful angle) [rad].
inline constexpr double kEscape = std::numbers::pi;

enum class RolloutStatus { kDone, kEscaped, kDiverged };
const char* name(RolloutStatus status);

}  // namespace ukemi::identify

// A landing motion: the joint reference of Sec. 4 of [1], which moves from phi_I to phi_F in `duration` after the first
// touchdown. Ours, and absent by default: shape terms, a move in the air before it, gains of its own. The
// definitions are in tools/docs/theory.md.
#pragma once

#include <array>
#include <limits>
#include <optional>

#include "common/sea_parameters.hpp"

namespace ukemi::landing {

/// Maximum number of shape terms of a motion.
inline constexpr int kMaxBumps = 4;
template <class T>
using BumpsOf = std::array<T, kMaxBumps>;

/// The move in the air: the reference is phi_R, the angle at release, until `from`; a quintic leads to phi_I at `to`.
template <class T>
struct RepositionOf {
  T phi;      ///< phi_R, joint angle at release, the spring relaxed [rad]
  T rate{0};  ///< of the joint at release [rad/s]
  T from{0};  ///< from release [s], >= 0
  T to{0};    ///< [s], > from
};

/// x = [phi_I phi_F t] of Eq. 6, and our additions. A motion with phi_i = phi_f and no bumps holds its reference.
template <class T>
struct MotionOf {
  T phi_i;                                      ///< phi_I, reference until the first touchdown [rad]
  T phi_f;                                      ///< phi_F, reference after the motion [rad]
  T duration;                                   ///< t, from phi_I to phi_F [s], > 0
  BumpsOf<T> bumps{T(0), T(0), T(0), T(0)};     ///< b_k, coefficients of the shape terms [rad]
  T gain_p{1}, gain_d{1};                       ///< factors of K_p and K_d from the start of the motion on, >= 0
  std::optional<RepositionOf<T>> reposition{};  ///< absent: released at phi_I, as in [1]

  /// Joint angle and rate at release.
  T release_phi() const { return reposition ? reposition->phi : phi_i; }
  T release_rate() const { return reposition ? reposition->rate : T(0); }
  /// This motion in another scalar.
  template <class U>
  MotionOf<U> cast() const {
    MotionOf<U> out{U(phi_i), U(phi_f), U(duration)};
    for (std::size_t k = 0; k < kMaxBumps; ++k) out.bumps[k] = U(bumps[k]);
    out.gain_p = U(gain_p), out.gain_d = U(gain_d);
    if (reposition) out.reposition = {U(reposition->phi), U(reposition->rate), U(reposition->from), U(reposition->to)};
    return out;
  }
};
using Motion = MotionOf<double>;
using Reposition = RepositionOf<double>;
/// Throws InputError for a number that is not finite or outside the range given with it. A move in the air that
/// never begins has both times infinite.
void validate(const Motion& motion);

/// Whether the reference moves before a landing motion that starts at a finite time from release.
bool moves_in_air(const Motion& m, double start);
/// The reference before the landing motion, `time` from release [s].
Reference<double> reference_before(const Motion& m, double time);
/// The motion with phi_I replaced by the reference at `time` from release, where its landing motion starts [s].
Motion started_at(const Motion& m, double time);
/// The reference of a landing motion from phi_I, `time` after its start [s]: phi_I before it, phi_F after its end.
Reference<double> reference_of(const Motion& m, double time);
/// Largest |dphi_ref| of a motion whose landing motion starts at `start` from release (infinite: after the move in the
/// air), the move included; without bumps 15/8 |phi_F - phi_I| / t, at its middle [rad/s].
double peak_reference_rate(const Motion& m, double start = std::numeric_limits<double>::infinity());

}  // namespace ukemi::landing

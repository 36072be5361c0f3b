// What a robot plays: the knee reference of Sec. 4 of [1], which moves from phi_I to phi_F in `duration` after the
// first touchdown. Ours, and absent by default: shape terms, a move in the air before it, gains of its own. The
// definitions are in tools/docs/theory.md.
#pragma once

#include <array>
#include <limits>
#include <optional>

#include "common/sea_parameters.hpp"

namespace ukemi::landing {

/// A motion has at most so many shape terms.
inline constexpr int kMostBumps = 4;
template <class T>
using BumpsOf = std::array<T, kMostBumps>;

/// The move in the air: the reference stands at phi_R, the joint's angle at release, until `from`; a quintic takes it
/// to phi_I at `to`. Ours.
template <class T>
struct RepositionOf {
  T phi;      ///< phi_R, joint angle at release, the spring relaxed [rad]
  T rate{0};  ///< of the joint at release [rad/s]
  T from{0};  ///< from release [s], >= 0
  T to{0};    ///< [s], > from
};

/// x = [phi_I phi_F t] of Eq. 6, and what we add to it. A motion with phi_i = phi_f and no bumps holds its reference.
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
    for (std::size_t k = 0; k < kMostBumps; ++k) out.bumps[k] = U(bumps[k]);
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
/// Where the reference is before the landing motion, `time` from release.
Reference<double> reference_before(const Motion& m, double time);
/// The landing motion that starts `time` from release, from where the reference is then: phi_I is replaced by it.
Motion started_at(const Motion& m, double time);
/// What a landing motion that starts at phi_I plays `time` after its start [s]: phi_I before it, phi_F after its end.
Reference<double> reference_of(const Motion& m, double time);
/// Largest |dphi_ref| of a motion whose landing starts at a time from release (infinite: once the move in the air is
/// over), the move included; without bumps 15/8 |phi_F - phi_I| / t, at its middle [rad/s].
double peak_reference_rate(const Motion& m, double start = std::numeric_limits<double>::infinity());

}  // namespace ukemi::landing

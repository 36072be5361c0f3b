// What a robot plays: the knee reference of Sec. 4 of [1], which moves from phi_I to phi_F in `duration` after the
// first touchdown. Ours, and absent by default: shape terms, a move in the air before it, gains of its own. The
// definitions are in tools/docs/theory.md.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>

#include "common/sea.hpp"

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

  /// The same motion in another scalar.
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
/// Throws InputError for a number that is not finite or outside the range that stands beside it. A move in the air that
/// never begins has both times infinite.
void validate(const Motion& motion);

/// The numbers of a motion, by their names; `to` is the end of the move in the air.
inline constexpr int kMotionNumbers = 10, kDurationSlot = 2, kBumpSlot = 3, kGainSlot = kBumpSlot + kMostBumps,
                     kToSlot = kGainSlot + 2;
inline constexpr std::array<const char*, kMotionNumbers> kMotionNames = {"phi_i", "phi_f", "duration", "b0",     "b1",
                                                                         "b2",    "b3",    "gain_p",   "gain_d", "to"};
/// They themselves; `none` stands for the `to` of a motion that does not move in the air.
template <class T>
std::array<T*, kMotionNumbers> motion_numbers(MotionOf<T>& m, T& none) {
  return {&m.phi_i,    &m.phi_f,    &m.duration, &m.bumps[0], &m.bumps[1],
          &m.bumps[2], &m.bumps[3], &m.gain_p,   &m.gain_d,   m.reposition ? &m.reposition->to : &none};
}

/// Where the reference stands: before a piece of it, in it, or after the landing motion.
enum class Phase : unsigned char { kBefore, kMoving, kAfter };
inline bool moving(Phase p) { return p == Phase::kMoving; }
inline bool after(Phase p) { return p == Phase::kAfter; }

/// The quintic with zero velocity and acceleration at both ends:
/// phi_ref = phi_I + (phi_F - phi_I) (10 s^3 - 15 s^4 + 6 s^5), s = time / duration in [0, 1]. Fig. 5 (b) of [1].
template <class T>
UKEMI_INLINE Reference<T> quintic(const T& phi_i, const T& phi_f, const T& duration, const T& time) {
  const T inverse = T(1) / duration, s = time * inverse, range = phi_f - phi_i, s2 = s * s, rest = s - s2;
  return {phi_i + range * (s2 * s * (T(10) + s * (T(-15) + T(6) * s))), range * inverse * (T(30) * rest * rest)};
}

/// sum_k b_k P_k(z) of Legendre's polynomials as the coefficients of the powers of z.
template <class T>
BumpsOf<T> powers_of(const BumpsOf<T>& b) {
  return {b[0] - T(0.5) * b[2], b[1] - T(1.5) * b[3], T(1.5) * b[2], T(2.5) * b[3]};
}

/// The shape terms: 64 s^3 (1 - s)^3 sum_k b_k P_k(2 s - 1), with zero velocity and acceleration at both ends; every
/// polynomial with such ends is a quintic and this. 64: b_0 is the height of its bump. `c`: see powers_of. Ours.
template <class T>
UKEMI_INLINE Reference<T> bumps_of(const BumpsOf<T>& c, const T& duration, const T& time) {
  const T inverse = T(1) / duration, s = time * inverse, z = T(2) * s - T(1), rest = s - s * s,
          q = c[0] + z * (c[1] + z * (c[2] + z * c[3])), dq = c[1] + z * (T(2) * c[2] + T(3) * z * c[3]);
  const T window = T(64) * rest * rest;
  return {window * rest * q, window * inverse * (T(2) * rest * dq - T(3) * z * q)};
}

/// What the reference does at a time: it stands at `a` before this piece, goes from a to b within it, and stands at b
/// after it.
template <class T>
struct ReferencePiece {
  T a{0}, b{0};   ///< [rad]
  T start{0};     ///< from release [s]
  T duration{1};  ///< [s]
  BumpsOf<T> powers{T(0), T(0), T(0), T(0)};

  /// The reference within the piece, at a time from release. `shaped`: with its bumps.
  UKEMI_INLINE Reference<T> at(const T& t, bool shaped) const {
    const T time = t - start;
    Reference<T> r = quintic(a, b, duration, time);
    if (!shaped) return r;
    const Reference<T> bump = bumps_of(powers, duration, time);
    return {r.phi + bump.phi, r.dphi + bump.dphi};
  }
  template <class U>
  ReferencePiece<U> cast() const {
    return {U(a), U(b), U(start), U(duration), {U(powers[0]), U(powers[1]), U(powers[2]), U(powers[3])}};
  }
  /// f(x's, y's) of every number.
  template <class A, class B, class F>
  static void for_each(A& x, const B& y, F&& f) {
    f(x.a, y.a), f(x.b, y.b), f(x.start, y.start), f(x.duration, y.duration);
    for (std::size_t k = 0; k < kMostBumps; ++k) f(x.powers[k], y.powers[k]);
  }
};

/// The reference standing still.
template <class T>
ReferencePiece<T> standing_at(const T& phi) {
  return {phi, phi};
}
/// The move in the air.
template <class T>
ReferencePiece<T> reposition_of(const MotionOf<T>& m) {
  const RepositionOf<T>& r = *m.reposition;
  return {r.phi, m.phi_i, r.from, r.to - r.from};
}
/// The landing motion from the angle that the reference has at its start.
template <class T>
ReferencePiece<T> landing_of(const MotionOf<T>& m, const T& from, const T& start) {
  return {from, m.phi_f, start, m.duration, powers_of(m.bumps)};
}

/// The drive as it is from the start of the landing motion on.
template <class T>
SeaParameters<T> with_landing_gains(SeaParameters<T> sea, const MotionOf<T>& m) {
  sea.k_p *= m.gain_p, sea.k_d *= m.gain_d;
  return sea;
}

/// What the reference turns to.
enum class Turn : unsigned char {
  kNone,
  kReposition,  ///< the move in the air
  kStand,       ///< at phi_I
  kLand,        ///< the landing motion, from where the reference is
  kHold,        ///< phi_F
};

/// The piece of the reference from the time t on. The move in the air may be under way where the landing motion begins.
template <class T>
ReferencePiece<T> piece_behind(Turn to, const MotionOf<T>& m, const ReferencePiece<T>& before, const T& t) {
  if (to == Turn::kReposition) return reposition_of(m);
  if (to == Turn::kStand) return standing_at(m.phi_i);
  if (to != Turn::kLand) return before;
  const bool over = value_of(t) >= value_of(before.start) + value_of(before.duration);
  return landing_of(m, over ? before.b : before.at(t, false).phi, t);
}

/// True where a motion has shape terms, or derivatives by them.
template <class T>
bool has_bumps(const MotionOf<T>& m) {
  for (const T& b : m.bumps) {
    if (value_of(b) != 0) return true;
    if constexpr (kDerivatives < T >> 0)
      if (!b.v.isZero(0)) return true;
  }
  return false;
}
/// Whether the reference moves at all, in the air or after the touchdown.
inline bool moves(const Motion& m) {
  const bool in_air = m.reposition && (std::isfinite(m.reposition->from) || m.reposition->phi != m.phi_f);
  return m.phi_i != m.phi_f || in_air || has_bumps(m);
}

/// Whether the reference moves before a landing motion that starts at a finite time from release.
bool moves_in_air(const Motion& m, double start);
/// Where the reference is before the landing motion, `time` from release.
Reference<double> reference_before(const Motion& m, double time);
/// The landing motion that starts `time` from release, from where the reference is then: phi_I is replaced by it.
Motion started_at(const Motion& m, double time);
/// What a landing motion that starts at phi_I plays `time` after its start [s]: phi_I before it, phi_F behind its end.
Reference<double> reference_of(const Motion& m, double time);
/// Largest |dphi_ref| of a motion whose landing starts at a time from release (infinite: once the move in the air is
/// over), the move included; without bumps 15/8 |phi_F - phi_I| / t, at its middle [rad/s].
double peak_reference_rate(const Motion& m, double start = std::numeric_limits<double>::infinity());

}  // namespace ukemi::landing

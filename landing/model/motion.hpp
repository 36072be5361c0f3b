// The reference piece by piece: the quintic of Fig. 5 (b) of [1], shape terms, the move in the air.
#pragma once

#include <array>
#include <cmath>

#include "common/sea.hpp"
#include "landing/model/motion_data.hpp"

namespace ukemi::landing {

/// The numbers of a motion, by their names; `to` is the end of the move in the air.
inline constexpr std::array kMotionNames = {"phi_i", "phi_f", "duration", "b0",     "b1",
                                            "b2",    "b3",    "gain_p",   "gain_d", "to"};
inline constexpr int kMotionNumbers = int(kMotionNames.size()), kDurationSlot = 2, kBumpSlot = 3,
                     kGainSlot = kBumpSlot + kMaxBumps, kToSlot = kGainSlot + 2;
static_assert(kToSlot + 1 == kMotionNumbers);
/// Pointers to these numbers; `none` stands in for `to` if the motion does not move in the air.
template <class T>
std::array<T*, kMotionNumbers> motion_numbers(MotionOf<T>& m, T& none) {
  return std::array{&m.phi_i,    &m.phi_f,    &m.duration, &m.bumps[0], &m.bumps[1],
                    &m.bumps[2], &m.bumps[3], &m.gain_p,   &m.gain_d,   m.reposition ? &m.reposition->to : &none};
}

/// Phase of the reference: constant before a piece, in a piece, or constant after the landing motion.
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

/// Coefficients of the powers of z in sum_k b_k P_k(z), P_k the Legendre polynomials.
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

/// A piece of the reference: a before it, from a to b within it, b after it.
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
  /// Calls f(number of x, same number of y) for every number.
  template <class A, class B, class F>
  static void for_each(A& x, const B& y, F&& f) {
    f(x.a, y.a), f(x.b, y.b), f(x.start, y.start), f(x.duration, y.duration);
    for (std::size_t k = 0; k < kMaxBumps; ++k) f(x.powers[k], y.powers[k]);
  }
};

/// A constant reference.
template <class T>
ReferencePiece<T> constant_reference(const T& phi) {
  return {phi, phi};
}
/// The move in the air.
template <class T>
ReferencePiece<T> reposition_of(const MotionOf<T>& m) {
  const RepositionOf<T>& r = *m.reposition;
  return {r.phi, m.phi_i, r.from, r.to - r.from};
}
/// The landing motion, starting at the angle `from`.
template <class T>
ReferencePiece<T> landing_of(const MotionOf<T>& m, const T& from, const T& start) {
  return {from, m.phi_f, start, m.duration, powers_of(m.bumps)};
}

/// The drive with the gains of the landing motion.
template <class T>
SeaParameters<T> with_landing_gains(SeaParameters<T> sea, const MotionOf<T>& m) {
  sea.k_p *= m.gain_p, sea.k_d *= m.gain_d;
  return sea;
}

/// Changes of the reference, and what follows.
enum class ReferenceChange : unsigned char {
  kReposition,   ///< the move in the air
  kHoldInitial,  ///< constant at phi_I
  kLand,         ///< the landing motion, from where the reference is
};

/// The piece of the reference after a change at the time t, which may interrupt the move in the air.
template <class T>
ReferencePiece<T> piece_after(ReferenceChange to, const MotionOf<T>& m, const ReferencePiece<T>& before, const T& t) {
  if (to == ReferenceChange::kReposition) return reposition_of(m);
  if (to == ReferenceChange::kHoldInitial) return constant_reference(m.phi_i);
  const bool ended = value_of(t) >= value_of(before.start) + value_of(before.duration);
  return landing_of(m, ended ? before.b : before.at(t, false).phi, t);
}

/// Whether a motion has shape terms, or derivatives by them.
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

}  // namespace ukemi::landing

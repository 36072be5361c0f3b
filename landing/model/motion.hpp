// The landing motion of Sec. 4: the knee reference moves from phi_I to phi_F in `duration` after the first touchdown.
#pragma once

#include "common/sea.hpp"

namespace ukemi::landing {

/// x = [phi_I phi_F t] of Eq. 6. A motion with phi_i = phi_f holds its reference.
template <class T>
struct MotionOf {
  T phi_i;     ///< phi_I, reference until the first touchdown [rad]
  T phi_f;     ///< phi_F, reference after the motion [rad]
  T duration;  ///< t, from phi_I to phi_F [s], > 0

  /// The same motion in another scalar.
  template <class U>
  MotionOf<U> cast() const {
    return {U(phi_i), U(phi_f), U(duration)};
  }
  /// f(a's, b's) of every number.
  template <class A, class B, class F>
  static void for_each(A& a, const B& b, F&& f) {
    f(a.phi_i, b.phi_i), f(a.phi_f, b.phi_f), f(a.duration, b.duration);
  }
};
using Motion = MotionOf<double>;

/// Where the reference stands: before the first touchdown, in the motion, after it.
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

/// What a motion plays `time` after the first touchdown, in [0, duration].
template <class T>
UKEMI_INLINE Reference<T> reference_of(const MotionOf<T>& m, const T& time) {
  return quintic(m.phi_i, m.phi_f, m.duration, time);
}
/// Whether it moves at all.
inline bool moves(const Motion& m) { return m.phi_i != m.phi_f; }

/// Largest |dphi_ref| of a motion, at its middle: 15/8 |phi_F - phi_I| / t [rad/s].
inline double peak_reference_rate(const Motion& m) {
  const double range = m.phi_f > m.phi_i ? m.phi_f - m.phi_i : m.phi_i - m.phi_f;
  return range == 0 ? 0 : 1.875 * range / m.duration;
}

}  // namespace ukemi::landing

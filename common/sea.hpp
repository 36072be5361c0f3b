// The series elastic actuator: Eq. 2-4 of the source paper, written once for every scalar.
//
// [1] Altangerel, Tsujita, Sekine, Abiko, "Generation of Shock Absorbing Motion of a One-Legged Robot with a Flexible
//     Joint", Sec. 2.3. The optional terms (stiffening spring, dry and viscous friction on either side,
//     motor-side feedback, a controller whose command is known, a late drive) are ours.
// SI units: rad, rad/s, Nm. The motor's angle is taken at the gear's output side; i_motor is the reflected inertia.
// Tests: test/unit/sea.cpp.
#pragma once

#include <Eigen/Core>
#include <limits>

#include "common/scalar.hpp"
#include "common/sea_parameters.hpp"

namespace ukemi {

/// Which optional terms a kernel is compiled with. A kernel without a term pays nothing for it.
struct SeaTerms {
  bool torque_limit = true;  ///< the clamp of Eq. 2
  bool extended = false;     ///< stiffening, friction and motor-side feedback
  bool late = false;         ///< a late drive: the states of DriveLag follow the others
};

/// True where the drive of `p` is late, or derivatives by its delay or filter are needed.
template <class T>
auto is_late(const SeaParameters<T>& p) {
  return present(p.control_delay) | present(p.velocity_filter);
}
/// Angles and rates on both sides of the spring.
template <class T>
struct SeaState {
  T phi;     ///< phi_1, output angle [rad]
  T phi_m;   ///< phi_m, motor angle [rad]
  T dphi;    ///< [rad/s]
  T dphi_m;  ///< [rad/s]
};

/// tau' = K_SEA d + K_3 d^3 + C_SEA d', d = phi_m - phi_1: the spring's torque on the output before the limit [Nm].
/// Eq. 2.
template <SeaTerms kTerms, Scalar T>
T spring_torque(const SeaParameters<T>& p, const SeaState<T>& s) {
  const T d = s.phi_m - s.phi;
  T torque = p.k_sea * d + p.c_sea * (s.dphi_m - s.dphi);
  if constexpr (kTerms.extended) torque += p.k_sea_cubic * d * d * d;
  return torque;
}

/// Whether a softening spring has collapsed at the deflection d [rad]: K_SEA + 3 K_3 d^2 <= 0. A run ends there.
inline bool gives_way(double k_sea, double k_sea_cubic, double d) {
  return k_sea_cubic < 0 && k_sea + 3 * k_sea_cubic * d * d <= 0;
}

/// d tau'/dt for given accelerations of both sides [Nm/s]; locates the torque limit in time.
template <SeaTerms kTerms, Scalar T>
T spring_torque_rate(const SeaParameters<T>& p, const SeaState<T>& s, const T& ddphi, const T& ddphi_m) {
  const T d_rate = s.dphi_m - s.dphi;
  T rate = p.k_sea * d_rate + p.c_sea * (ddphi_m - ddphi);
  if constexpr (kTerms.extended) {
    const T d = s.phi_m - s.phi;
    rate += T(3) * p.k_sea_cubic * d * d * d_rate;
  }
  return rate;
}

/// The branch of Eq. 2's clamp, held between events: -1, 0 or +1.
inline bool at_upper(int saturation) { return saturation > 0; }
inline bool at_lower(int saturation) { return saturation < 0; }

/// tau_SEA = clamp(tau', -tau_max, tau_max), Eq. 2, with the branch held.
template <SeaTerms kTerms, Scalar T, class Saturation>
T limited_torque(const SeaParameters<T>& p, const T& torque, const Saturation& saturation) {
  if constexpr (kTerms.torque_limit)
    return select(at_upper(saturation), p.tau_max, select(at_lower(saturation), T(-p.tau_max), torque));
  else
    return torque;
}

/// tau_mot = K_p (phi_ref - phi) + K_d (dphi_ref - dphi), Eq. 3; phi is phi_1, or phi_m with motor-side feedback [Nm].
template <SeaTerms kTerms, Scalar T>
T motor_torque(const SeaParameters<T>& p, const SeaState<T>& s, const Reference<T>& ref) {
  if constexpr (kTerms.extended) {
    const bool motor = p.feedback == Feedback::kMotor;
    return p.k_p * (ref.phi - select(motor, s.phi_m, s.phi)) + p.k_d * (ref.dphi - select(motor, s.dphi_m, s.dphi));
  } else {
    return p.k_p * (ref.phi - s.phi) + p.k_d * (ref.dphi - s.dphi);
  }
}

/// A late drive. With u the torque of Eq. 3, or of a known controller, computed from what is measured,
///
///     tau_mot(t) = u(t - T_d),     u = K_p (phi_ref - phi) + K_d (dphi_ref - v),     v' = (dphi - v) / T_v
///
/// so that the reference is as late as the angle: both are read in one cycle. As a linear system the delay is Pade's
/// approximant of exp(-x), x = s T_d, of the orders 2 and 3, N(x) / D(x) with D = 1 + 3/5 x + 3/20 x^2 + 1/60 x^3; its
/// error is |x|^6 / 7200: 2e-6 of u at 100 rad/s and 5 ms. N is exp(-x) D up to its square, and that also where T_d is
/// below `kShortestDelay`, whose poles then replace its own: no delay, however short, is stiff, and the torque and
/// its derivative by T_d are right at T_d = 0 too, to (100 rad/s 0.5 ms)^3 / 60 = 2e-6. T_v likewise: exact from
/// kShortestFilter on and at 0, else right to first order in frequency. Ours.
/// Sources: Pade (1892); Ehle (1969): of these orders it is L-stable. Tests: test/unit/drive_lag.cpp.
template <Scalar T>
class DriveLag {
 public:
  enum { kFirst, kSecond, kThird, kRate, kStates };  ///< the delay's three [Nm], the first driven by u; v [rad/s]
  using State = Eigen::Matrix<T, kStates, 1>;

  explicit DriveLag(const SeaParameters<T>& p)
      : motor_(p.feedback == Feedback::kMotor),
        delayed_(present(p.control_delay)),
        delay_rate_(T(1) / time_constant(p.control_delay, kShortestDelay)),
        filter_rate_(T(1) / time_constant(p.velocity_filter, kShortestFilter)),
        direct_(T(1) - p.velocity_filter * filter_rate_) {
    const T ratio = p.control_delay * delay_rate_;  // N = exp(-ratio x) D(x) up to x^2
    second_ = T(kD1) - ratio;
    first_ = T(kD2) - ratio * (T(kD1) - T(0.5) * ratio);
  }

  /// The actuator as the drive sees it: the rate that is fed back is filtered.
  template <class X>
  SeaState<T> filtered(SeaState<T> s, const X& x) const {
    T& rate = motor_ ? s.dphi_m : s.dphi;
    rate = x[kRate] + direct_ * (rate - x[kRate]);
    return s;
  }
  /// tau_mot for the torque u that the drive demands now [Nm].
  template <class X>
  T torque(const T& u, const X& x) const {
    return select(delayed_, T(x[kThird] + second_ * x[kSecond] + first_ * x[kFirst]), u);
  }
  /// dx/dt; s is not filtered.
  template <class X>
  State derivative(const T& u, const SeaState<T>& s, const X& x) const {
    const T first_rate = (u - x[kThird] - T(kD1) * x[kSecond] - T(kD2) * x[kFirst]) * T(1 / kD3);
    return {first_rate * delay_rate_, x[kFirst] * delay_rate_, x[kSecond] * delay_rate_,
            (fed_back(s) - x[kRate]) * filter_rate_};
  }
  /// Magnitude of its fastest pole [1/s]; the zeros of D are within |x| = kPole.
  double fastest_pole() const {
    constexpr double kPole = 4.07;
    return std::max(kPole * value_of(delay_rate_), double(value_of(filter_rate_)));
  }
  /// Steady state: rate and demanded torque have been constant for ever.
  State steady(const T& u, const SeaState<T>& s) const { return {T(0), T(0), u, fed_back(s)}; }

  /// Conversion to another scalar, by values.
  template <class U>
  explicit DriveLag(const DriveLag<U>& o)
      : motor_(o.motor_),
        delayed_(o.delayed_),
        delay_rate_(value_of(o.delay_rate_)),
        filter_rate_(value_of(o.filter_rate_)),
        direct_(value_of(o.direct_)),
        second_(value_of(o.second_)),
        first_(value_of(o.first_)) {}

  static constexpr double kShortestDelay = 5e-4, kShortestFilter = 1e-4;  ///< [s]

 private:
  template <Scalar U>
  friend class DriveLag;
  static constexpr double kD1 = 3.0 / 5, kD2 = 3.0 / 20, kD3 = 1.0 / 60;  // coefficients of D
  static constexpr double kIdle = 1e-2;  // of an absent delay or filter, whose state is not used [s]

  const T& fed_back(const SeaState<T>& s) const { return motor_ ? s.dphi_m : s.dphi; }
  static T time_constant(const T& value, double shortest) {
    return select(present(value), select(value > T(shortest), value, T(shortest)), T(kIdle));
  }

  bool motor_;
  typename MaskOf<T>::type delayed_;
  T delay_rate_, filter_rate_, direct_, second_, first_;
};
/// In place of DriveLag in a kernel whose drive is not late.
template <Scalar T>
struct NoLag {
  enum { kStates };
  template <class Constants>
  explicit NoLag(const Constants&) {}
};

/// Coulomb torque against motion in a direction, +1 or -1: tau_c (1 + direction asymmetry) [Nm]. The asymmetry is half
/// the difference of both levels over their mean. Ours.
template <class T>
T coulomb_level(const T& mean, const T& asymmetry, const T& direction) {
  return mean * (T(1) + direction * asymmetry);
}

/// Coulomb torque that grows with the transmitted torque: tau_c + eta |tau_SEA|, |tau| = sqrt(tau^2 + e^2) - e,
/// e = 10 mNm [Nm]. Ours.
template <class T>
T loaded_friction(const T& tau_c, const T& eta, const T& tau_sea) {
  using std::sqrt;
  constexpr double kSmoothing = 0.01;  // e
  return tau_c + eta * (sqrt(tau_sea * tau_sea + T(kSmoothing * kSmoothing)) - T(kSmoothing));
}

/// Stribeck's factor of a Coulomb torque at a speed: 1 + breakaway exp(-speed / v_s), so that a side breaks away at
/// 1 + breakaway times what it slides with. speed >= 0 [rad/s]. Ours.
template <class T>
T stribeck(const T& breakaway, const T& v_s, const T& speed) {
  using std::exp;
  return T(1) + breakaway * exp(-speed / v_s);
}

/// The two sides of the actuator, each with its own friction. A motor that turns with its joint counts to the output
/// side.
enum Side { kOutputSide, kMotorSide, kSides };

/// Coulomb's torque against a motion in `direction`, +1 or -1, at the rate v: direction L, L = `coulomb_level` times
/// `stribeck` [Nm]; nothing where direction is 0.
template <Scalar T>
T coulomb_torque(const SeaParameters<T>& p, const T& mean, const T& asymmetry, const T& direction, const T& v) {
  T torque = direction * coulomb_level(mean, asymmetry, direction);
  if (any(present(p.breakaway))) torque *= stribeck(p.breakaway, p.stribeck_speed, T(direction * v));
  return torque;
}
/// tau_SEA - viscous friction: what turns the joint, without dry friction [Nm].
template <SeaTerms kTerms, Scalar T>
T output_torque(const SeaParameters<T>& p, const T& dphi, const T& tau_sea) {
  if constexpr (kTerms.extended)
    return tau_sea - p.output_viscous * dphi;
  else
    return tau_sea;
}

/// tau_mot - tau_SEA - viscous friction: what turns the motor, without dry friction [Nm].
template <SeaTerms kTerms, Scalar T>
T torque_on_motor(const SeaParameters<T>& p, const T& dphi_m, const T& tau_mot, const T& tau_sea) {
  T torque = tau_mot - tau_sea;
  if constexpr (kTerms.extended) torque -= p.viscous * dphi_m;
  return torque;
}

/// ddphi_m = (tau_mot - tau_SEA - viscous friction) / I_motor, Eq. 4, without delay, velocity filter and dry friction
/// [rad/s^2].
template <SeaTerms kTerms, Scalar T>
T motor_acceleration(const SeaParameters<T>& p, const SeaState<T>& s, const Reference<T>& ref, const T& tau_sea) {
  return torque_on_motor<kTerms>(p, s.dphi_m, motor_torque<kTerms>(p, s, ref), tau_sea) / p.i_motor;
}

}  // namespace ukemi

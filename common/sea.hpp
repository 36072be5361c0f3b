// The series elastic actuator: Eq. 2-4 of the source paper, written once for every scalar.
//
// [1] Altangerel, Tsujita, Sekine, Abiko, "Generation of Shock Absorbing Motion of a One-Legged Robot with a Flexible
//     Joint", Sec. 2.3. The optional terms (stiffening spring, dry and viscous friction on either side,
//     motor-side feedback, a controller whose command is known, a drive that is late) are ours.
// SI units: rad, rad/s, Nm. The motor's angle is taken at the gear's output side; i_motor is the reflected inertia.
// Tests: test/unit/sea.cpp.
#pragma once

#include <Eigen/Core>
#include <limits>

#include "common/scalar.hpp"

namespace ukemi {

/// Which angle Eq. 3 feeds back: the output angle phi_1 as printed in [1], or the motor angle phi_m as many real drives
/// do.
enum class Feedback { kOutput, kMotor };

/// Below this speed dry friction is smoothed in a landing, v_f in `smoothed_friction` [rad/s]. Ours. On the rig it
/// sticks: identify/rig/one_link.hpp.
inline constexpr double kFrictionSpeed = 0.005;

/// The constants of one series elastic actuator.
template <class T>
struct SeaParameters {
  T k_p;                                                   ///< K_p, proportional gain [Nm/rad], >= 0
  T k_d;                                                   ///< K_d, derivative gain [Nm/(rad/s)], >= 0
  T k_sea;                                                 ///< K_SEA, stiffness of the spring [Nm/rad], >= 0
  T c_sea;                                                 ///< C_SEA, damping of the spring [Nm/(rad/s)], >= 0
  T i_motor;                                               ///< I_motor, reflected motor inertia [kg m^2], > 0
  T tau_max = T(std::numeric_limits<double>::infinity());  ///< limit of the spring torque [Nm], >= 0; infinite: none
  T friction = T(0);                                       ///< tau_c, Coulomb torque on the motor [Nm], >= 0; 0: none
  T k_sea_cubic = T(0);                                    ///< K_3, cubic stiffness [Nm/rad^3]; < 0: a softening spring
  Feedback feedback = Feedback::kOutput;                   ///< what Eq. 3 feeds back
  T viscous = T(0);                    ///< viscous friction on the motor [Nm/(rad/s)], >= 0; 0: none
  T output_friction = T(0);            ///< Coulomb torque on the output [Nm], >= 0; 0: none
  T output_viscous = T(0);             ///< viscous friction on the output [Nm/(rad/s)], >= 0; 0: none
  T friction_asymmetry = T(0);         ///< of `friction`, see coulomb_level; -1..1
  T k_t = T(0);                        ///< K_t, the motor's torque for a unit of its command [Nm/unit], >= 0; 0: none
  T output_friction_asymmetry = T(0);  ///< of `output_friction`; -1..1
  T breakaway = T(0);                  ///< of both Coulomb torques, see stribeck; >= 0; 0: none
  T stribeck_speed = T(0.05);          ///< v_s of the same [rad/s], > 0
  T spring_loss = T(0);      ///< eta, dry friction on the motor that grows with the spring's torque, see loaded
  T control_delay = T(0);    ///< T_d, from what a drive measures to its torque [s], >= 0; see DriveLag
  T velocity_filter = T(0);  ///< T_v, time constant of the low-pass of the rate that K_d sees [s], >= 0; the same

  /// The same constants in another scalar.
  template <class U>
  SeaParameters<U> cast() const {
    SeaParameters<U> out{U(k_p), U(k_d), U(k_sea), U(c_sea), U(i_motor)};
    for_each(out, *this, [](U& to, const T& from) { to = U(from); });
    out.feedback = feedback;
    return out;
  }
  /// f(a's, b's) of every constant.
  template <class A, class B, class F>
  static void for_each(A& a, const B& b, F&& f) {
    f(a.k_p, b.k_p), f(a.k_d, b.k_d), f(a.k_sea, b.k_sea), f(a.c_sea, b.c_sea), f(a.i_motor, b.i_motor);
    f(a.tau_max, b.tau_max), f(a.friction, b.friction), f(a.k_sea_cubic, b.k_sea_cubic), f(a.viscous, b.viscous);
    f(a.k_t, b.k_t), f(a.output_friction, b.output_friction), f(a.output_viscous, b.output_viscous);
    f(a.friction_asymmetry, b.friction_asymmetry), f(a.output_friction_asymmetry, b.output_friction_asymmetry);
    f(a.breakaway, b.breakaway), f(a.stribeck_speed, b.stribeck_speed), f(a.spring_loss, b.spring_loss);
    f(a.control_delay, b.control_delay), f(a.velocity_filter, b.velocity_filter);
  }
};

/// Which optional terms a kernel is compiled with. A kernel without a term pays nothing for it.
struct SeaTerms {
  bool torque_limit = true;  ///< the clamp of Eq. 2
  bool extended = false;     ///< stiffening, friction and motor-side feedback
  bool late = false;         ///< a drive that is late, whose states then stand behind the others: DriveLag
};

/// True where the drive of `p` is late, or a derivative by how late it is is asked for.
template <class T>
auto is_late(const SeaParameters<T>& p) {
  return present(p.control_delay) | present(p.velocity_filter);
}
/// True where `p` needs the extended kernel.
inline bool is_extended(const SeaParameters<double>& p) {
  return p.friction != 0 || p.viscous != 0 || p.output_friction != 0 || p.output_viscous != 0 || p.k_sea_cubic != 0 ||
         p.spring_loss != 0 || p.feedback == Feedback::kMotor || is_late(p);
}

/// Angles and rates on both sides of the spring.
template <class T>
struct SeaState {
  T phi;     ///< phi_1, output angle [rad]
  T phi_m;   ///< phi_m, motor angle [rad]
  T dphi;    ///< [rad/s]
  T dphi_m;  ///< [rad/s]
};

/// The reference that Eq. 3 follows.
template <class T>
struct Reference {
  T phi;   ///< phi_ref [rad]
  T dphi;  ///< dphi_ref [rad/s]
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

/// Whether a spring that softens, bent by d, no longer resists: its tangent stiffness K_SEA + 3 K_3 d^2 is not above 0.
/// No run follows it there.
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

/// A drive that is late. With u the torque of Eq. 3, or of a controller that is known, worked out of what is measured,
///
///     tau_mot(t) = u(t - T_d),     u = K_p (phi_ref - phi) + K_d (dphi_ref - v),     v' = (dphi - v) / T_v
///
/// so that the reference is as late as the angle: both are read in one cycle. As a linear system the delay is Pade's
/// approximant of exp(-x), x = s T_d, of the orders 2 and 3, N(x) / D(x) with D = 1 + 3/5 x + 3/20 x^2 + 1/60 x^3; it
/// errs by |x|^6 / 7200: 2e-6 of u at 100 rad/s and 5 ms. N is exp(-x) D up to its square, and that also where T_d is
/// below `kShortest`, whose poles then stand in place of its own: no delay, however short, is stiff, and the torque and
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
        per_delay_(T(1) / pole(p.control_delay, kShortest)),
        per_filter_(T(1) / pole(p.velocity_filter, kShortestFilter)),
        direct_(T(1) - p.velocity_filter * per_filter_) {
    const T part = p.control_delay * per_delay_;  // of exp(-part x) D(x)
    second_ = T(kD1) - part;
    first_ = T(kD2) - part * (T(kD1) - T(0.5) * part);
  }

  /// The actuator as the drive sees it: the rate that is fed back is filtered.
  template <class X>
  SeaState<T> seen(SeaState<T> s, const X& x) const {
    T& rate = motor_ ? s.dphi_m : s.dphi;
    rate = x[kRate] + direct_ * (rate - x[kRate]);
    return s;
  }
  /// tau_mot where u is what the drive asks for now [Nm].
  template <class X>
  T torque(const T& u, const X& x) const {
    return select(delayed_, T(x[kThird] + second_ * x[kSecond] + first_ * x[kFirst]), u);
  }
  /// dx/dt; s as it is, not as it is seen.
  template <class X>
  State derivative(const T& u, const SeaState<T>& s, const X& x) const {
    const T over = (u - x[kThird] - T(kD1) * x[kSecond] - T(kD2) * x[kFirst]) * T(1 / kD3);
    return {over * per_delay_, x[kFirst] * per_delay_, x[kSecond] * per_delay_, (fed_back(s) - x[kRate]) * per_filter_};
  }
  /// Of a drive that has seen the same rate and asked for the same torque for ever.
  State steady(const T& u, const SeaState<T>& s) const { return {T(0), T(0), u, fed_back(s)}; }

  /// The same in another scalar, by values.
  template <class U>
  explicit DriveLag(const DriveLag<U>& o)
      : motor_(o.motor_),
        delayed_(o.delayed_),
        per_delay_(value_of(o.per_delay_)),
        per_filter_(value_of(o.per_filter_)),
        direct_(value_of(o.direct_)),
        second_(value_of(o.second_)),
        first_(value_of(o.first_)) {}

  static constexpr double kShortest = 5e-4, kShortestFilter = 1e-4;  ///< [s]

 private:
  template <Scalar U>
  friend class DriveLag;
  static constexpr double kD1 = 3.0 / 5, kD2 = 3.0 / 20, kD3 = 1.0 / 60;  // of D
  static constexpr double kIdle = 1e-2;  // of what is not there, whose state has no say [s]

  const T& fed_back(const SeaState<T>& s) const { return motor_ ? s.dphi_m : s.dphi; }
  static T pole(const T& time, double shortest) {
    return select(present(time), select(time > T(shortest), time, T(shortest)), T(kIdle));
  }

  bool motor_;
  typename MaskOf<T>::type delayed_;
  T per_delay_, per_filter_, direct_, second_, first_;
};
/// In a kernel whose drive is not late.
template <Scalar T>
struct NoLag {
  enum { kStates };
  template <class Constants>
  explicit NoLag(const Constants&) {}
};

/// Coulomb torque against motion in a direction, +1 or -1: tau_c (1 + direction asymmetry) [Nm]. The asymmetry is half
/// the difference of both levels over their mean. Ours.
template <class T>
T coulomb_level(const T& mean, const T& asymmetry, int direction) {
  return mean * (T(1) + T(direction) * asymmetry);
}

/// tau_c + eta |tau_SEA|: a transmission rubs the more the more it carries. |tau| = sqrt(tau^2 + e^2) - e, e = 10 mNm
/// [Nm]. Ours.
template <class T>
T loaded(const T& tau_c, const T& eta, const T& tau_sea) {
  using std::sqrt;
  constexpr double kSmall = 0.01;  // e
  return tau_c + eta * (sqrt(tau_sea * tau_sea + T(kSmall * kSmall)) - T(kSmall));
}

/// Stribeck's factor of a Coulomb torque at a speed: 1 + breakaway exp(-speed / v_s), so that a side breaks away at
/// 1 + breakaway times what it slides with. speed >= 0 [rad/s]. Ours.
template <class T>
T stribeck(const T& breakaway, const T& v_s, const T& speed) {
  using std::exp;
  return T(1) + breakaway * exp(-speed / v_s);
}

/// Friction of one side against its motion at the rate v, as a landing has it: Coulomb's torque by `coulomb_level` and
/// `stribeck` with v / s for the sign of v and s = sqrt(v^2 + v_f^2) for |v|, and viscous v [Nm]. Ours.
template <Scalar T>
T smoothed_friction(const SeaParameters<T>& p, const T& mean, const T& asymmetry, const T& viscous, const T& v) {
  using std::sqrt;
  const T s = sqrt(v * v + T(kFrictionSpeed * kFrictionSpeed)), direction = v / s;
  T coulomb = mean * direction * (T(1) + direction * asymmetry);
  if (any(value_of(p.breakaway) != value_of(T(0)))) coulomb *= stribeck(p.breakaway, p.stribeck_speed, s);
  return coulomb + viscous * v;
}

/// On the motor, in Eq. 4.
template <SeaTerms kTerms, Scalar T>
T friction_torque(const SeaParameters<T>& p, const T& dphi_m, const T& tau_sea) {
  if constexpr (kTerms.extended)
    return smoothed_friction(p, loaded(p.friction, p.spring_loss, tau_sea), p.friction_asymmetry, p.viscous, dphi_m);
  else
    return T(0);
}
/// tau_SEA less the friction on the output: what turns the joint [Nm].
template <SeaTerms kTerms, Scalar T>
T output_torque(const SeaParameters<T>& p, const T& dphi, const T& tau_sea) {
  if constexpr (kTerms.extended)
    return tau_sea - smoothed_friction(p, p.output_friction, p.output_friction_asymmetry, p.output_viscous, dphi);
  else
    return tau_sea;
}

/// ddphi_m = (tau_mot - tau_SEA - friction) / I_motor, Eq. 4 [rad/s^2].
template <SeaTerms kTerms, Scalar T>
T motor_acceleration(const SeaParameters<T>& p, const T& dphi_m, const T& tau_mot, const T& tau_sea) {
  T torque = tau_mot - tau_sea;
  if constexpr (kTerms.extended) torque -= friction_torque<kTerms>(p, dphi_m, tau_sea);
  return torque / p.i_motor;
}
/// The same of a drive that is not late.
template <SeaTerms kTerms, Scalar T>
T motor_acceleration(const SeaParameters<T>& p, const SeaState<T>& s, const Reference<T>& ref, const T& tau_sea) {
  return motor_acceleration<kTerms>(p, s.dphi_m, motor_torque<kTerms>(p, s, ref), tau_sea);
}

}  // namespace ukemi

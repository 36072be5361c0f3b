// The constants of a series elastic actuator (Sec. 2.3 of [1]; the optional ones are ours). Its law: common/sea.hpp.
//
// SI units: rad, rad/s, Nm. The motor's angle is taken at the gear's output side; i_motor is the reflected inertia.
#pragma once

#include <limits>

namespace ukemi {

/// Which angle Eq. 3 feeds back: the output angle phi_1 as printed in [1], or the motor angle phi_m as many real drives
/// do.
enum class Feedback { kOutput, kMotor };
const char* name(Feedback feedback);  ///< "output", "motor"

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
  T stribeck_speed = T(0.05);          ///< v_s, see stribeck [rad/s], > 0
  T spring_loss = T(0);      ///< eta, dry friction on the motor per spring torque, see loaded_friction; >= 0; 0: none
  T control_delay = T(0);    ///< T_d, from what a drive measures to its torque [s], >= 0; see DriveLag
  T velocity_filter = T(0);  ///< T_v, time constant of the low-pass of the rate that K_d sees [s], >= 0; see DriveLag

  /// These constants in another scalar.
  template <class U>
  SeaParameters<U> cast() const {
    SeaParameters<U> out{U(k_p), U(k_d), U(k_sea), U(c_sea), U(i_motor)};
    for_each(out, *this, [](U& to, const T& from) { to = U(from); });
    out.feedback = feedback;
    return out;
  }
  /// Calls f(a.x, b.x) for every constant x.
  template <class A, class B, class F>
  static constexpr void for_each(A& a, const B& b, F&& f) {
    f(a.k_p, b.k_p), f(a.k_d, b.k_d), f(a.k_sea, b.k_sea), f(a.c_sea, b.c_sea), f(a.i_motor, b.i_motor);
    f(a.tau_max, b.tau_max), f(a.friction, b.friction), f(a.k_sea_cubic, b.k_sea_cubic), f(a.viscous, b.viscous);
    f(a.k_t, b.k_t), f(a.output_friction, b.output_friction), f(a.output_viscous, b.output_viscous);
    f(a.friction_asymmetry, b.friction_asymmetry), f(a.output_friction_asymmetry, b.output_friction_asymmetry);
    f(a.breakaway, b.breakaway), f(a.stribeck_speed, b.stribeck_speed), f(a.spring_loss, b.spring_loss);
    f(a.control_delay, b.control_delay), f(a.velocity_filter, b.velocity_filter);
  }
};

/// Whether it has any of the optional terms but tau_max.
inline bool is_extended(const SeaParameters<double>& p) {
  return p.friction != 0 || p.viscous != 0 || p.output_friction != 0 || p.output_viscous != 0 || p.k_sea_cubic != 0 ||
         p.spring_loss != 0 || p.feedback == Feedback::kMotor || p.control_delay != 0 || p.velocity_filter != 0;
}

/// The reference that Eq. 3 follows.
template <class T>
struct Reference {
  T phi;   ///< phi_ref [rad]
  T dphi;  ///< dphi_ref [rad/s]
};

}  // namespace ukemi

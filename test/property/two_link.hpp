// The two-link floating-base robot in the vertical plane, Eq. 1 of [1] in a reduced form: a second derivation, against
// which tests hold the equations of robots of links.
//
// The total centre of mass R moves only under the contact forces and decouples from the two absolute angles
// theta_0 = phi_0 (thigh) and theta_1 = phi_0 + phi_1 (shank):
//
//     R'' = sum_j F_j / (m_0 + m_1) + (0, -g)
//     [A C] [ddtheta_0]   [-tau + sum_j j0_j n(theta_0).F_j - C' dtheta_1^2]     mu = m_0 m_1 / (m_0 + m_1)
//     [C B] [ddtheta_1] = [+tau + sum_j j1_j n(theta_1).F_j + C' dtheta_0^2]     A = I_0 + mu a^2, B = I_1 + mu a^2
//                                                                                C = mu a^2 cos(theta_0 - theta_1)
//                                                                                C' = mu a^2 sin(theta_0 - theta_1)
// World: x forward, y up, floor at y = 0; u(theta) = (sin, -cos) points along a link, n(theta) = du/dtheta; a = l/2.
// [1] Altangerel, Tsujita, Sekine, Abiko, Sec. 2.1, 2.2. The reduction is ours; test/property/two_link.cpp holds it
// against a generic H(q) ddq + c + g build.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>

#include "common/scalar.hpp"
#include "landing/model/constants.hpp"

namespace test {

using ukemi::landing::kPoints, ukemi::landing::TwoLink;

/// Components of its state.
enum Component { kX, kY, kTheta0, kTheta1, kPhiM, kVx, kVy, kOmega0, kOmega1, kOmegaM, kMechanical };
template <class T>
using Vector2 = Eigen::Matrix<T, 2, 1>;

/// Coefficients of the equations, computed once per run. T may be double if states have no derivatives by them.
template <class T>
class TwoLinkDynamics {
 public:
  explicit TwoLinkDynamics(const TwoLink<T>& r)
      : total_mass(r.mass[0] + r.mass[1]),
        inverse_mass(T(1) / total_mass),
        gravity(r.gravity),
        a(r.link_length * T(0.5)),
        k1(r.mass[1] * inverse_mass),
        arm0{-(T(1) + k1) * a, (T(1) - k1) * a, (T(1) - k1) * a},
        arm1{-k1 * a, -k1 * a, r.link_length - k1 * a},
        mu_a2(r.mass[0] * k1 * a * a),
        inertia0(r.inertia_com[0] + mu_a2),
        inertia1(r.inertia_com[1] + mu_a2) {}

  T total_mass, inverse_mass, gravity;
  T a;                          ///< half a link [m]
  T k1;                         ///< m_1 / (m_0 + m_1)
  std::array<T, kPoints> arm0;  ///< j0: a point is R + j0 u(theta_0) + j1 u(theta_1)
  std::array<T, kPoints> arm1;  ///< j1
  T mu_a2, inertia0, inertia1;  ///< mu a^2, A, B
};

/// Position, velocities, sines and cosines of both angles, and their rates.
template <class T>
struct Pose {
  T x, y, vx, vy, s0, c0, s1, c1, omega0, omega1;
};

/// Accelerations of the reduced coordinates.
template <class T>
struct Accelerations {
  T x, y, theta0, theta1;
};

/// Height of a point above the floor [m].
template <class C, class T>
T height(const TwoLinkDynamics<C>& d, const Pose<T>& p, int point) {
  return p.y - d.arm0[point] * p.c0 - d.arm1[point] * p.c1;
}
/// Horizontal place of a point [m].
template <class C, class T>
T place(const TwoLinkDynamics<C>& d, const Pose<T>& p, int point) {
  return p.x + d.arm0[point] * p.s0 + d.arm1[point] * p.s1;
}
/// Velocity of a point [m/s].
template <class C, class T>
T velocity_x(const TwoLinkDynamics<C>& d, const Pose<T>& p, int point) {
  return p.vx + d.arm0[point] * p.omega0 * p.c0 + d.arm1[point] * p.omega1 * p.c1;
}
template <class C, class T>
T velocity_y(const TwoLinkDynamics<C>& d, const Pose<T>& p, int point) {
  return p.vy + d.arm0[point] * p.omega0 * p.s0 + d.arm1[point] * p.omega1 * p.s1;
}
/// Vertical acceleration of a point [m/s^2].
template <class C, class T>
T acceleration_y(const TwoLinkDynamics<C>& d, const Pose<T>& p, const Accelerations<T>& acc, int point) {
  return acc.y + d.arm0[point] * (acc.theta0 * p.s0 + p.omega0 * p.omega0 * p.c0) +
         d.arm1[point] * (acc.theta1 * p.s1 + p.omega1 * p.omega1 * p.c1);
}

/// Generalised contact forces: add each point's force, then `solve`.
template <class T>
struct Loads {
  T fx{0}, fy{0}, q0{0}, q1{0};

  /// A force (x, y) [N] at `point`.
  template <class C>
  void add(const TwoLinkDynamics<C>& d, const Pose<T>& p, int point, const T& x, const T& y) {
    fx += x, fy += y;
    q0 += d.arm0[point] * (p.c0 * x + p.s0 * y);
    q1 += d.arm1[point] * (p.c1 * x + p.s1 * y);
  }
};

/// Eq. 1 solved for the accelerations; tau is the joint torque tau_SEA, positive where it extends phi_1 [Nm].
template <class C, class T>
Accelerations<T> solve(const TwoLinkDynamics<C>& d, const Pose<T>& p, const T& tau, const Loads<T>& load) {
  const T c = d.mu_a2 * (p.c0 * p.c1 + p.s0 * p.s1), cs = d.mu_a2 * (p.s0 * p.c1 - p.c0 * p.s1);
  const T r0 = load.q0 - tau - cs * p.omega1 * p.omega1, r1 = load.q1 + tau + cs * p.omega0 * p.omega0;
  const T inverse = T(1) / (d.inertia0 * d.inertia1 - c * c);
  return {load.fx * d.inverse_mass, load.fy * d.inverse_mass - d.gravity, (d.inertia1 * r0 - c * r1) * inverse,
          (d.inertia0 * r1 - c * r0) * inverse};
}

/// ddr_0, acceleration of the thigh's centre of mass [m/s^2]: r_0 = R - k1 a (u(theta_0) + u(theta_1)).
template <class C, class T>
Vector2<T> thigh_acceleration(const TwoLinkDynamics<C>& d, const Pose<T>& p, const Accelerations<T>& acc) {
  const C k = d.k1 * d.a;
  const T w0 = p.omega0 * p.omega0, w1 = p.omega1 * p.omega1;
  return {acc.x - k * (acc.theta0 * p.c0 - w0 * p.s0 + acc.theta1 * p.c1 - w1 * p.s1),
          acc.y - k * (acc.theta0 * p.s0 + w0 * p.c0 + acc.theta1 * p.s1 + w1 * p.c1)};
}

/// r_0 and its velocity.
template <class C, class T>
Vector2<T> thigh_position(const TwoLinkDynamics<C>& d, const Pose<T>& p) {
  const C k = d.k1 * d.a;
  return {p.x - k * (p.s0 + p.s1), p.y + k * (p.c0 + p.c1)};
}
template <class C, class T>
Vector2<T> thigh_velocity(const TwoLinkDynamics<C>& d, const Pose<T>& p) {
  const C k = d.k1 * d.a;
  return {p.vx - k * (p.omega0 * p.c0 + p.omega1 * p.c1), p.vy - k * (p.omega0 * p.s0 + p.omega1 * p.s1)};
}

/// Kinetic energy of both links about and with the centre of mass [J].
template <class C, class T>
T kinetic_energy(const TwoLinkDynamics<C>& d, const Pose<T>& p) {
  const T c = d.mu_a2 * (p.c0 * p.c1 + p.s0 * p.s1);
  return T(0.5) * (d.total_mass * (p.vx * p.vx + p.vy * p.vy) + d.inertia0 * p.omega0 * p.omega0 +
                   d.inertia1 * p.omega1 * p.omega1 + T(2) * c * p.omega0 * p.omega1);
}

}  // namespace test

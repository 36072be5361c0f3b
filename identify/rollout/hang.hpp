// Static equilibrium of a rig under gravity. Included by roll.hpp only.
#pragma once

#include <Eigen/LU>

#include "identify/rig/one_link.hpp"

namespace ukemi::identify {

/// Sets the angles of y to the equilibrium under gravity, without friction, plus `offset`. With a reference `phi`:
/// where spring and motor carry the link. With a known command: the link at phi, the motor where the spring carries it.
/// Newton's method on the two torques, with exact derivatives; leaves y unchanged where the Jacobian is singular.
template <class System, class T, class State>
void set_hanging_equilibrium(const System& rig, const Drive& drive, double phi, const T& offset, State& y) {
  using Dual = ceres::Jet<double, 2>;
  constexpr int kMaxIterations = 50;
  constexpr double kTolerance = 1e-14;
  const bool known_command = drive.known_command();
  const T link = T(phi) + offset;
  const auto residual = [&](auto system, const auto& x, const auto& angle) {
    using U = std::decay_t<decltype(x[0])>;
    system.input = {};
    system.input.phi_ref = phi;
    auto steady = x;
    system.steady(0.0, steady);
    const std::array<U, kSides> torque = system.torques(0.0, steady);
    return Eigen::Matrix<U, 2, 1>(
        torque[kOutputSide], known_command ? U(x[System::kPhi] - angle) : U(torque[kOutputSide] + torque[kMotorSide]));
  };
  Eigen::Vector2d x = Eigen::Vector2d::Constant(known_command ? value_of(link) : phi);
  Eigen::Matrix2d inverse = Eigen::Matrix2d::Zero();
  const auto dual = rig.template cast_values<Dual>();
  using DualState = typename std::decay_t<decltype(dual)>::State;
  for (int i = 0; i < kMaxIterations; ++i) {
    DualState state = DualState::Zero();
    state[System::kPhi] = Dual(x[0], 0), state[System::kPhiM] = Dual(x[1], 1);
    const auto f = residual(dual, state, Dual(value_of(link)));
    Eigen::Matrix2d jacobian;
    for (int row = 0; row < 2; ++row) jacobian.row(row) = f[row].v.transpose();
    bool invertible;
    jacobian.computeInverseWithCheck(inverse, invertible);
    if (!invertible) return;
    const Eigen::Vector2d step = inverse * Eigen::Vector2d(f[0].a, f[1].a);
    x -= step;
    if (step.norm() < kTolerance * (1 + x.norm())) break;
  }
  State state = State::Zero();
  state[System::kPhi] = T(x[0]), state[System::kPhiM] = T(x[1]);
  const Eigen::Matrix<T, 2, 1> remaining = residual(rig, state, link);  // 0 but for its derivatives
  for (const int i : {0, 1}) {
    const T angle = state[i] - (T(inverse(i, 0)) * remaining[0] + T(inverse(i, 1)) * remaining[1]);
    y[i] = known_command ? angle : T(angle + offset);
  }
}

}  // namespace ukemi::identify

// Where a rig that hangs is at rest. Included by roll.hpp, by no other.
#pragma once

#include <Eigen/LU>

#include "identify/rig/one_link.hpp"

namespace ukemi::identify {

/// Puts the angles of y to where gravity leaves them at rest, friction apart, and then `offset` off: about a reference
/// of `phi` to where spring and motor carry the link; where only a command is known, the link is at phi and the motor
/// where the spring carries it. Newton's method on the two torques, with exact derivatives; as y is where nothing
/// carries it.
template <class System, class T, class State>
void hang(const System& rig, const Drive& drive, double phi, const T& offset, State& y) {
  using Dual = ceres::Jet<double, 2>;
  constexpr int kMost = 50;
  constexpr double kEnough = 1e-14;
  const bool by_command = drive.by_command();
  const T link = T(phi) + offset;
  const auto lacking = [&](auto system, const auto& x, const auto& angle) {
    using U = std::decay_t<decltype(x[0])>;
    system.input = {};
    system.input.phi_ref = phi;
    auto still = x;
    system.steady(0.0, still);
    const std::array<U, kSides> torque = system.torques(0.0, still);
    return Eigen::Matrix<U, 2, 1>(
        torque[kOutputSide], by_command ? U(x[System::kPhi] - angle) : U(torque[kOutputSide] + torque[kMotorSide]));
  };
  Eigen::Vector2d x = Eigen::Vector2d::Constant(by_command ? value_of(link) : phi);
  Eigen::Matrix2d inverse = Eigen::Matrix2d::Zero();
  const auto duals = rig.template in_values<Dual>();
  using Duals = typename std::decay_t<decltype(duals)>::State;
  for (int i = 0; i < kMost; ++i) {
    Duals at = Duals::Zero();
    at[System::kPhi] = Dual(x[0], 0), at[System::kPhiM] = Dual(x[1], 1);
    const auto f = lacking(duals, at, Dual(value_of(link)));
    Eigen::Matrix2d slopes;
    for (int row = 0; row < 2; ++row) slopes.row(row) = f[row].v.transpose();
    bool invertible;
    slopes.computeInverseWithCheck(inverse, invertible);
    if (!invertible) return;
    const Eigen::Vector2d step = inverse * Eigen::Vector2d(f[0].a, f[1].a);
    x -= step;
    if (step.norm() < kEnough * (1 + x.norm())) break;
  }
  State at = State::Zero();
  at[System::kPhi] = T(x[0]), at[System::kPhiM] = T(x[1]);
  const Eigen::Matrix<T, 2, 1> left = lacking(rig, at, link);  // 0 but for its derivatives
  for (const int i : {0, 1}) {
    const T angle = at[i] - (T(inverse(i, 0)) * left[0] + T(inverse(i, 1)) * left[1]);
    y[i] = by_command ? angle : T(angle + offset);
  }
}

}  // namespace ukemi::identify

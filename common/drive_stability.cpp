#include "common/drive_stability.hpp"

#include <Eigen/Eigenvalues>

namespace ukemi {

double growth_rate(const SeaParameters<double>& sea, double inertia) {
  constexpr SeaTerms kTerms{.torque_limit = false, .extended = true};
  SeaParameters<double> linear = sea;
  linear.friction = linear.spring_loss = linear.output_friction = linear.k_sea_cubic = 0;
  Eigen::Matrix4d a;  // of [phi_1 phi_m dphi_1 dphi_m], column by column
  for (int j = 0; j < 4; ++j) {
    const Eigen::Vector4d y = Eigen::Vector4d::Unit(j);
    const SeaState<double> s{y[0], y[1], y[2], y[3]};
    const double tau = spring_torque<kTerms>(linear, s);
    a.col(j) << s.dphi, s.dphi_m, output_torque<kTerms>(linear, s.dphi, tau) / inertia,
        motor_acceleration<kTerms>(linear, s, {0, 0}, tau);
  }
  const auto eigenvalues = Eigen::EigenSolver<Eigen::Matrix4d>(a, false).eigenvalues();
  constexpr double kRounding = 1e-7;  // two eigenvalues at 0, of a drive without gains, come out as large as that
  const double rate = eigenvalues.real().maxCoeff();
  return std::abs(rate) > kRounding * eigenvalues.cwiseAbs().maxCoeff() ? rate : 0;
}

}  // namespace ukemi

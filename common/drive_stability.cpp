#include "common/drive_stability.hpp"

#include <Eigen/Eigenvalues>

namespace ukemi {

namespace {

/// dy/dt of [phi_1 phi_m dphi_1 dphi_m], and of DriveLag's states where N is larger.
template <int N>
Eigen::Matrix<double, N, N> linear_field(const SeaParameters<double>& sea, double inertia) {
  constexpr SeaTerms kTerms{.torque_limit = false, .extended = true};
  constexpr int kMotion = 4;
  const DriveLag<double> lag(sea);
  Eigen::Matrix<double, N, N> a;  // column by column
  for (int j = 0; j < N; ++j) {
    const Eigen::Matrix<double, N, 1> y = Eigen::Matrix<double, N, 1>::Unit(j);
    const SeaState<double> s{y[0], y[1], y[2], y[3]};
    const double tau = spring_torque<kTerms>(sea, s);
    double driving;
    if constexpr (N > kMotion) {
      const auto x = y.template tail<N - kMotion>();
      const double asked = motor_torque<kTerms>(sea, lag.seen(s, x), {0, 0});
      driving = lag.torque(asked, x);
      a.col(j).template tail<N - kMotion>() = lag.derivative(asked, s, x);
    } else {
      driving = motor_torque<kTerms>(sea, s, {0, 0});
    }
    a.col(j).template head<kMotion>() << s.dphi, s.dphi_m, output_torque<kTerms>(sea, s.dphi, tau) / inertia,
        motor_acceleration<kTerms>(sea, s.dphi_m, driving, tau);
  }
  return a;
}

double largest_real_part(const Eigen::MatrixXd& a) {
  const auto eigenvalues = Eigen::EigenSolver<Eigen::MatrixXd>(a, false).eigenvalues();
  constexpr double kRounding = 1e-7;  // two eigenvalues at 0, of a drive without gains, come out as large as that
  const double rate = eigenvalues.real().maxCoeff();
  return std::abs(rate) > kRounding * eigenvalues.cwiseAbs().maxCoeff() ? rate : 0;
}

}  // namespace

double growth_rate(const SeaParameters<double>& sea, double inertia) {
  SeaParameters<double> linear = sea;
  linear.friction = linear.spring_loss = linear.output_friction = linear.k_sea_cubic = 0;
  constexpr int kPrompt = 4, kLate = kPrompt + DriveLag<double>::kStates;
  return is_late(linear) ? largest_real_part(linear_field<kLate>(linear, inertia))
                         : largest_real_part(linear_field<kPrompt>(linear, inertia));
}

}  // namespace ukemi

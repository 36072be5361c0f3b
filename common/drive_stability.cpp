#include "common/drive_stability.hpp"

#include <Eigen/Eigenvalues>
#include <vector>

namespace ukemi {

namespace {

/// dy/dt = A y of y = [phi dphi] of all joints, then of each that is elastic [phi_m dphi_m], and DriveLag's states
/// where it is late.
class LinearField {
 public:
  LinearField(std::span<const LinearJoint> joints, const Eigen::MatrixXd& compliance)
      : joints_(joints), compliance_(compliance) {
    const int n = int(joints.size());
    size_ = 2 * n;
    for (int i = 0; i < n; ++i) {
      motor_.push_back(size_);
      if (joint(i).elastic) size_ += kMotor + (is_late(*joint(i).elastic) ? kLags : 0);
    }
  }
  Eigen::MatrixXd matrix() const {
    Eigen::MatrixXd out(size_, size_);
    for (int k = 0; k < size_; ++k) out.col(k) = derivative(Eigen::VectorXd::Unit(size_, k));
    return out;
  }
  /// Whose rates are the largest in a direction y.
  int moving_most(const Eigen::VectorXcd& y) const {
    const int n = int(joints_.size());
    int most = 0;
    double largest = -1;
    for (int i = 0; i < n; ++i)
      for (const int k : {n + i, joint(i).elastic ? motor_[std::size_t(i)] + 1 : n + i})
        if (const double rate = std::abs(y[k]); rate > largest) largest = rate, most = i;
    return most;
  }

 private:
  static constexpr SeaTerms kTerms{.torque_limit = false, .extended = true};
  static constexpr int kMotor = 2, kLags = DriveLag<double>::kStates;

  const LinearJoint& joint(int i) const { return joints_[std::size_t(i)]; }
  Eigen::VectorXd derivative(const Eigen::VectorXd& y) const {
    const int n = int(joints_.size());
    Eigen::VectorXd out = Eigen::VectorXd::Zero(size_), torque(n);
    for (int i = 0; i < n; ++i) {
      const LinearJoint& j = joint(i);
      torque[i] = -j.stiffness * y[i] - j.damping * y[n + i];
      if (j.elastic) torque[i] += elastic_torque(*j.elastic, y[i], y[n + i], y, motor_[std::size_t(i)], out);
    }
    out.head(n) = y.segment(n, n), out.segment(n, n) = compliance_ * torque;
    return out;
  }
  /// On the joint [Nm]; the motor's rates go to `out` from `at` on.
  static double elastic_torque(const SeaParameters<double>& sea, double phi, double dphi, const Eigen::VectorXd& y,
                               int at, Eigen::VectorXd& out) {
    const SeaState<double> s{phi, y[at], dphi, y[at + 1]};
    const double tau = spring_torque<kTerms>(sea, s);
    double driving = 0;
    if (is_late(sea)) {
      const DriveLag<double> lag(sea);
      const DriveLag<double>::State x = y.segment<kLags>(at + kMotor);
      const double asked = motor_torque<kTerms>(sea, lag.seen(s, x), {0, 0});
      driving = lag.torque(asked, x), out.segment<kLags>(at + kMotor) = lag.derivative(asked, s, x);
    } else {
      driving = motor_torque<kTerms>(sea, s, {0, 0});
    }
    out[at] = s.dphi_m, out[at + 1] = torque_on_motor<kTerms>(sea, s.dphi_m, driving, tau) / sea.i_motor;
    return output_torque<kTerms>(sea, dphi, tau);
  }

  std::span<const LinearJoint> joints_;
  Eigen::MatrixXd compliance_;
  std::vector<int> motor_;  ///< where each joint's begins
  int size_;
};

}  // namespace

Growth growth(std::span<const LinearJoint> joints, const Eigen::MatrixXd& compliance) {
  std::vector<SeaParameters<double>> linear(joints.size());
  std::vector<LinearJoint> of(joints.begin(), joints.end());
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (!of[i].elastic) continue;
    linear[i] = *of[i].elastic, of[i].elastic = &linear[i];
    linear[i].friction = linear[i].spring_loss = linear[i].output_friction = linear[i].k_sea_cubic = 0;
  }
  const LinearField field(of, compliance);
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(field.matrix());
  constexpr double kRounding = 1e-7;  // two eigenvalues at 0, of a drive without gains, come out as large as that
  Eigen::Index worst = 0;
  const double rate = solver.eigenvalues().real().maxCoeff(&worst);
  if (!(std::abs(rate) > kRounding * solver.eigenvalues().cwiseAbs().maxCoeff())) return {};
  return {rate, field.moving_most(solver.eigenvectors().col(worst))};
}

double growth_rate(const SeaParameters<double>& sea, double inertia) {
  const LinearJoint joint{.elastic = &sea};
  return growth({&joint, 1}, Eigen::MatrixXd::Constant(1, 1, 1 / inertia)).rate;
}

}  // namespace ukemi

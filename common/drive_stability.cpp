#include "common/drive_stability.hpp"

#include <Eigen/Eigenvalues>
#include <vector>

namespace ukemi {

namespace {

/// dy/dt = A y with y = [phi dphi] of all joints, then [phi_m dphi_m] of each elastic joint, followed by the states of
/// DriveLag where its drive is late.
class LinearField {
 public:
  LinearField(std::span<const LinearJoint> joints, const Eigen::MatrixXd& compliance)
      : joints_(joints), compliance_(compliance) {
    const int n = int(joints.size());
    size_ = 2 * n;
    for (int i = 0; i < n; ++i) {
      motor_offset_.push_back(size_);
      if (joint(i).elastic) size_ += kMotor + (is_late(*joint(i).elastic) ? kLags : 0);
    }
  }
  Eigen::MatrixXd matrix() const {
    Eigen::MatrixXd out(size_, size_);
    for (int k = 0; k < size_; ++k) out.col(k) = derivative(Eigen::VectorXd::Unit(size_, k));
    return out;
  }
  /// The joint with the largest rates in an eigenvector y.
  int fastest_joint(const Eigen::VectorXcd& y) const {
    const int n = int(joints_.size());
    int fastest = 0;
    double largest = -1;
    for (int i = 0; i < n; ++i)
      for (const int k : {n + i, joint(i).elastic ? motor_offset_[std::size_t(i)] + 1 : n + i})
        if (const double rate = std::abs(y[k]); rate > largest) largest = rate, fastest = i;
    return fastest;
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
      if (j.elastic) torque[i] += elastic_torque(*j.elastic, y[i], y[n + i], y, motor_offset_[std::size_t(i)], out);
    }
    out.head(n) = y.segment(n, n), out.segment(n, n) = compliance_ * torque;
    return out;
  }
  /// Torque on the joint [Nm]; the derivatives of the motor's states go to `out` from `offset` on.
  static double elastic_torque(const SeaParameters<double>& sea, double phi, double dphi, const Eigen::VectorXd& y,
                               int offset, Eigen::VectorXd& out) {
    const SeaState<double> s{phi, y[offset], dphi, y[offset + 1]};
    const double tau = spring_torque<kTerms>(sea, s);
    double drive_torque = 0;
    if (is_late(sea)) {
      const DriveLag<double> lag(sea);
      const DriveLag<double>::State x = y.segment<kLags>(offset + kMotor);
      const double demand = motor_torque<kTerms>(sea, lag.filtered(s, x), {0, 0});
      drive_torque = lag.torque(demand, x), out.segment<kLags>(offset + kMotor) = lag.derivative(demand, s, x);
    } else {
      drive_torque = motor_torque<kTerms>(sea, s, {0, 0});
    }
    out[offset] = s.dphi_m, out[offset + 1] = torque_on_motor<kTerms>(sea, s.dphi_m, drive_torque, tau) / sea.i_motor;
    return output_torque<kTerms>(sea, dphi, tau);
  }

  std::span<const LinearJoint> joints_;
  Eigen::MatrixXd compliance_;
  std::vector<int> motor_offset_;  ///< index in y of each joint's motor states
  int size_;
};

}  // namespace

Growth growth(std::span<const LinearJoint> joints, const Eigen::MatrixXd& compliance) {
  std::vector<SeaParameters<double>> linear(joints.size());
  std::vector<LinearJoint> linearized(joints.begin(), joints.end());
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (!linearized[i].elastic) continue;
    linear[i] = *linearized[i].elastic, linearized[i].elastic = &linear[i];
    linear[i].friction = linear[i].spring_loss = linear[i].output_friction = linear[i].k_sea_cubic = 0;
  }
  const LinearField field(linearized, compliance);
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(field.matrix());
  constexpr double kRounding = 1e-7;  // relative size of a computed double eigenvalue 0 (a drive without gains)
  Eigen::Index worst = 0;
  const double rate = solver.eigenvalues().real().maxCoeff(&worst);
  if (!(std::abs(rate) > kRounding * solver.eigenvalues().cwiseAbs().maxCoeff())) return {};
  return {rate, field.fastest_joint(solver.eigenvectors().col(worst))};
}

double growth_rate(const SeaParameters<double>& sea, double inertia) {
  const LinearJoint joint{.elastic = &sea};
  return growth({&joint, 1}, Eigen::MatrixXd::Constant(1, 1, 1 / inertia)).rate;
}

}  // namespace ukemi

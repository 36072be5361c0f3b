#include "common/integrate/dense_lu.hpp"

#include <Eigen/LU>

namespace ukemi::integrate {

struct DenseLu::Factors {
  Eigen::PartialPivLU<Eigen::MatrixXd> lu;
};

DenseLu::DenseLu() = default;
DenseLu::~DenseLu() = default;

void DenseLu::compute(const double* matrix, int n) {
  if (!factors_) factors_ = std::make_unique<Factors>();
  factors_->lu.compute(Eigen::Map<const Eigen::MatrixXd>(matrix, n, n));
}

void DenseLu::solve(double* x) const {
  Eigen::Map<Eigen::VectorXd> solution(x, factors_->lu.rows());
  solution = factors_->lu.solve(solution);
}

}  // namespace ukemi::integrate

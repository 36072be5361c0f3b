#include "common/integrate/dense_lu.hpp"

#include <Eigen/LU>
#include <vector>

namespace ukemi::integrate {

struct DenseLu::Factors {
  Eigen::PartialPivLU<Eigen::MatrixXd> lu;

  /// Those of this thread that no DenseLu has, so that runs after the first do not allocate.
  static std::vector<std::unique_ptr<Factors>>& unused() {
    thread_local std::vector<std::unique_ptr<Factors>> out = [] {
      std::vector<std::unique_ptr<Factors>> first;
      first.push_back(std::make_unique<Factors>());
      return first;
    }();
    return out;
  }
};

DenseLu::DenseLu() = default;
DenseLu::~DenseLu() {
  auto& unused = Factors::unused();
  if (factors_) unused.push_back(std::move(factors_));
}

void DenseLu::compute(const double* matrix, int n) {
  if (auto& unused = Factors::unused(); !factors_ && !unused.empty())
    factors_ = std::move(unused.back()), unused.pop_back();
  if (!factors_) factors_ = std::make_unique<Factors>();
  factors_->lu.compute(Eigen::Map<const Eigen::MatrixXd>(matrix, n, n));
}

void DenseLu::solve(double* x) const {
  Eigen::Map<Eigen::VectorXd> solution(x, factors_->lu.rows());
  solution = factors_->lu.solve(solution);
}

}  // namespace ukemi::integrate

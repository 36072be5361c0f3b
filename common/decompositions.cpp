#include "common/decompositions.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

namespace ukemi {

SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

struct LeastNorm::Decomposition {
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
};

LeastNorm::LeastNorm(const Eigen::MatrixXd& a, std::optional<double> threshold) {
  auto d = std::make_shared<Decomposition>();
  if (threshold) d->solver.setThreshold(*threshold);
  d->solver.compute(a);
  decomposition_ = std::move(d);
}

Eigen::MatrixXd LeastNorm::solve(const Eigen::MatrixXd& b) const { return decomposition_->solver.solve(b); }
Eigen::MatrixXd LeastNorm::pseudo_inverse() const { return decomposition_->solver.pseudoInverse(); }
long LeastNorm::rank() const { return decomposition_->solver.rank(); }

}  // namespace ukemi

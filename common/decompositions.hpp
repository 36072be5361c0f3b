// Decompositions of matrices of any size, each compiled once: Eigen's cost 10 to 20 s in every file that names them.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

namespace ukemi {

struct SymmetricEigen {
  Eigen::VectorXd values;   ///< in increasing order
  Eigen::MatrixXd vectors;  ///< one a column, of unit length; at least one
};

/// Eigenvalues and vectors of a symmetric matrix, of which the lower triangle is read.
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& matrix);

/// Minimum-norm least-squares solution of A x = b for A of any rank, by a complete orthogonal decomposition.
class LeastNorm {
 public:
  /// A pivot below `threshold` times the largest counts as zero; absent: below rounding.
  explicit LeastNorm(const Eigen::MatrixXd& a, std::optional<double> threshold = {});
  Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const;
  Eigen::MatrixXd pseudo_inverse() const;
  long rank() const;

 private:
  struct Decomposition;
  std::shared_ptr<const Decomposition> decomposition_;
};

}  // namespace ukemi

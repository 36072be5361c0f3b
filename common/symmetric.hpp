// The eigenvectors of a symmetric matrix; compiled once, for Eigen's solver costs 10 s in every file that names it.
#pragma once

#include <Eigen/Core>

namespace ukemi {

struct SymmetricEigen {
  Eigen::VectorXd values;   ///< rising
  Eigen::MatrixXd vectors;  ///< of unit length, a column each; of one dimension or more
};

/// Of a square matrix, of which the lower triangle is read.
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& matrix);

}  // namespace ukemi

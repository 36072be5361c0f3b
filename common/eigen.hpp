// The matrices of results as Eigen's, without a copy.
#pragma once

#include <Eigen/Core>

#include "common/uncertainty.hpp"

namespace ukemi {

inline Eigen::Map<const Eigen::MatrixXd> eigen(const DenseMatrix& m) { return {m.data(), m.rows(), m.cols()}; }
inline Eigen::Map<Eigen::MatrixXd> eigen(DenseMatrix& m) { return {m.data(), m.rows(), m.cols()}; }

}  // namespace ukemi

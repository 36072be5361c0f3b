// What the residuals at a minimum say of the parameters' errors.
#pragma once

#include "identify/estimate/least_squares.hpp"

namespace ukemi::identify {

/// Fills in what of a solution speaks of errors: the information of the globals with the locals eliminated block by
/// block (Schur complement), and from it the covariances. `squares`, of each block: [J r]' [J r] in scaled parameters,
/// globals, locals, residual.
void add_covariances(const LeastSquaresProblem& problem, const std::vector<const Eigen::MatrixXd*>& squares,
                     LeastSquaresSolution& out);

/// c_ij / sqrt(c_ii c_jj); NaN where the covariance is.
Eigen::MatrixXd correlation_of(const Eigen::MatrixXd& covariance);

}  // namespace ukemi::identify

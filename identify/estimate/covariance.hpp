// The covariances of the parameters from the residuals' derivatives at a minimum.
#pragma once

#include "common/decompositions.hpp"
#include "identify/estimate/least_squares.hpp"

namespace ukemi::identify {

/// Gradient of half the cost by the scaled globals, at their values `scaled`: of the blocks' `grams` (see
/// add_covariances) and the priors.
Eigen::VectorXd gradient_at(const LeastSquaresProblem& problem, const std::vector<const Eigen::MatrixXd*>& grams,
                            const std::vector<double>& scaled);

/// Fills in a solution's information of the globals, with the locals eliminated block by block (Schur complement), and
/// from it the covariances, which are NaN before. `grams`: the Gram matrix [J r]' [J r] of each block in scaled
/// parameters: globals, locals, residual.
void add_covariances(const LeastSquaresProblem& problem, const std::vector<const Eigen::MatrixXd*>& grams,
                     LeastSquaresSolution& out);

/// The least-norm solution of a x = b, scaled by units that make a's diagonal 1.
class ScaledSolver {
 public:
  explicit ScaledSolver(const Eigen::MatrixXd& a)
      : unit_(a.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse()),
        decomposition_(unit_.asDiagonal() * a * unit_.asDiagonal(), 1e-12) {}
  Eigen::MatrixXd operator()(const Eigen::MatrixXd& b) const {
    return unit_.asDiagonal() * decomposition_.solve(unit_.asDiagonal() * b);
  }
  long rank() const { return decomposition_.rank(); }

 private:
  Eigen::VectorXd unit_;
  LeastNorm decomposition_;
};

/// c_ij / sqrt(c_ii c_jj); NaN where the covariance is.
Eigen::MatrixXd correlation_of(const Eigen::MatrixXd& covariance);

}  // namespace ukemi::identify

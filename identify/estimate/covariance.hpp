// What the residuals at a minimum say of the parameters' errors.
#pragma once

#include "common/decompositions.hpp"
#include "identify/estimate/least_squares.hpp"

namespace ukemi::identify {

/// Of half the cost by the globals, at their scaled values, of what `squares` are (add_covariances) and of the priors;
/// by scaled globals.
Eigen::VectorXd slope_at(const LeastSquaresProblem& problem, const std::vector<const Eigen::MatrixXd*>& squares,
                         const std::vector<double>& scaled);

/// Fills in what of a solution speaks of errors: the information of the globals with the locals eliminated block by
/// block (Schur complement), and from it the covariances. `squares`, of each block: [J r]' [J r] in scaled parameters,
/// globals, locals, residual.
void add_covariances(const LeastSquaresProblem& problem, const std::vector<const Eigen::MatrixXd*>& squares,
                     LeastSquaresSolution& out);

/// The solution of a x = b by units that make a's diagonal 1; directions that a says nothing of are left alone.
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

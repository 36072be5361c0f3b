// Derivatives of the residuals at a fit's minimum, by the fitted parameters and by terms that were not fitted.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "identify/estimate/covariance.hpp"
#include "identify/fit/fit.hpp"
#include "identify/fit/rig_terms.hpp"
#include "identify/fit/weighting.hpp"

namespace ukemi::identify {

/// Sums over parts of the logs of [J T L r]' [J T L r]: derivatives of the residuals r by the fitted parameters off
/// their bounds (J), by further terms that all trials share (T), and by those that each trial has (L); the fitted
/// terms of single trials are eliminated.
struct Sensitivity {
  std::vector<Eigen::MatrixXd> parts;      ///< trial by trial
  int parts_per_trial = 1;                 ///< so that there are more parts than parameters
  std::vector<RigTerm> shared, per_trial;  ///< the further terms
  std::vector<int> free;                   ///< columns of J: indices of Fit::fitted
  Eigen::MatrixXd information;             ///< J' J and the priors'
  Eigen::VectorXd gradient;                ///< J' r and the priors': 0 at the minimum
  double variance = 0;                     ///< of a residual

  int parameters() const { return int(free.size()); }
  int trials() const { return int(parts.size()) / parts_per_trial; }
  /// Sum of all parts; of those of one trial.
  Eigen::MatrixXd gram() const { return sum(0, int(parts.size())); }
  Eigen::MatrixXd gram_of(int trial) const { return sum(trial * parts_per_trial, parts_per_trial); }

 private:
  Eigen::MatrixXd sum(int first, int count) const;
};

/// Where a fit ended.
struct MinimumPoint {
  std::vector<double> globals;              ///< as Estimates::fitted
  std::vector<bool> at_bound;               ///< of the globals
  std::vector<std::vector<double>> locals;  ///< of each block
  std::vector<double> further;              ///< values of the further shared terms
};
[[nodiscard]] MinimumPoint point_of(const Estimates& fit, std::size_t blocks);
/// The sensitivity of a least-squares problem at a point: its globals are the fitted ones, then the further shared
/// terms; its locals those of each block, then the further ones, at their absent values. `further` holds these terms.
/// None where a block cannot be evaluated, or all globals are at bounds.
[[nodiscard]] std::optional<Sensitivity> sensitivity_at(const LeastSquaresProblem& problem, const MinimumPoint& point,
                                                        Sensitivity further, double huber);

/// The minimum of a fit: its input, where it ended, and its trials there. What it refers to must outlive it.
struct FitMinimum {
  const Rig& rig;
  const std::vector<Trial>& trials;
  const FitOptions& options;
  const Fit& fit;  ///< `sea` and `trials` are read
  MinimumPoint point;
};
/// The sensitivity to every absent term, and to those of which the rig states an error (not tested unless absent).
/// None where a trial cannot be simulated.
[[nodiscard]] std::optional<Sensitivity> sensitivity_of(const FitMinimum& minimum);

/// Whether the rig of any trial states an error of a term that was not fitted.
[[nodiscard]] bool states_errors(const FitMinimum& minimum);
/// The terms of stated error, with their effect on the fitted parameters.
[[nodiscard]] std::vector<Considered> considered_of(const FitMinimum& minimum, const Sensitivity& sensitivity);
/// std J' W j of the further term in a column of the sensitivity: a column for each trial, std(m) of its own; of a term
/// that all share their sum.
[[nodiscard]] Eigen::MatrixXd effect_of(const Sensitivity& sensitivity, int column, Scope scope,
                                        const std::function<double(std::size_t trial)>& std);
/// The effect of a term of standard deviation `std` on the fitted parameters, from its effect_of. `solve`: of the
/// sensitivity's information; `fitted`: number of Estimates::fitted.
[[nodiscard]] Considered considered(const Sensitivity& sensitivity, const ScaledSolver& solve, const std::string& name,
                                    double std, const Eigen::MatrixXd& effect, std::size_t fitted);

}  // namespace ukemi::identify

// The residuals at a fit's minimum, and how they move with what was fitted and with terms that were not.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "identify/estimate/covariance.hpp"
#include "identify/fit/fit.hpp"
#include "identify/fit/rig_terms.hpp"
#include "identify/fit/weighting.hpp"

namespace ukemi::identify {

/// Sums over parts of the logs of [J T L r]' [J T L r]: derivatives of the residuals r by what was fitted and is off
/// its bounds, by further terms that all trials share, and by those that each has; a trial's own fitted terms
/// eliminated.
struct Sensitivity {
  std::vector<Eigen::MatrixXd> parts;     ///< trial by trial
  int parts_of_trial = 1;                 ///< as many for each, so that there are well more parts than parameters
  std::vector<RigTerm> shared, of_trial;  ///< the further terms
  std::vector<int> free;                  ///< what J is by: indices of Fit::fitted
  Eigen::MatrixXd information;            ///< J' J and the priors'
  Eigen::VectorXd slope;                  ///< J' r and the priors': 0 at the minimum
  double variance = 0;                    ///< of a residual

  int parameters() const { return int(free.size()); }
  int columns() const { return int(parts.front().cols()); }
  int trials() const { return int(parts.size()) / parts_of_trial; }
  /// Sum over the parts of a block of them.
  Eigen::MatrixXd sum(int row, int column, int rows, int columns) const;
};

/// Where a fit ended.
struct MinimumPoint {
  std::vector<double> globals;              ///< as Estimates::fitted
  std::vector<bool> at_bound;               ///< of these
  std::vector<std::vector<double>> locals;  ///< of each block
  std::vector<double> further;              ///< values of the further terms that all share
};
/// Of any least-squares problem there: its globals are those that were fitted, then the further shared terms; its
/// locals those of each block, then its further ones, at their absence. `further` holds these terms. None where a block
/// cannot be evaluated, or nothing is off its bounds.
[[nodiscard]] std::optional<Sensitivity> sensitivity_at(const LeastSquaresProblem& problem, const MinimumPoint& point,
                                                        Sensitivity further, double huber);

/// A minimum: what was fitted, how, and where it ended. What it names must outlive it.
struct AtMinimum {
  const Rig& rig;
  const std::vector<Trial>& trials;
  const FitOptions& options;
  const SeaParameters<double>& sea;
  std::vector<Weighting> weights;
  std::vector<double> globals;              ///< as Fit::fitted
  std::vector<bool> at_bound;               ///< of these
  std::vector<std::vector<double>> locals;  ///< of each trial
};
/// By every term that is absent, and by those that the rig states an error of (not tested where they are not absent).
/// None where a trial cannot be followed.
[[nodiscard]] std::optional<Sensitivity> sensitivity_of(const AtMinimum& at);

/// Whether the rig of any trial states an error of a term that was not fitted.
[[nodiscard]] bool states_errors(const AtMinimum& at);
/// These terms, with what they do to the constants.
[[nodiscard]] std::vector<Considered> considered_of(const AtMinimum& at, const Sensitivity& sensitivity);
/// What a term of standard deviation `std` does to what was fitted, from its effect std J' W j, a column for each
/// independent draw of it; `solve`: by the sensitivity's information; `fitted` as the number of Estimates::fitted.
[[nodiscard]] Considered considered(const Sensitivity& sensitivity, const ScaledSolver& solve, const std::string& name,
                                    double std, const Eigen::MatrixXd& effect, std::size_t fitted);

}  // namespace ukemi::identify

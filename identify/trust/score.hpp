// The residuals at a fit's minimum and how they move with what was fitted, and with what was not: score tests of every
// term that the fit could carry, and errors that do not take each sample for news.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "identify/fit/fit.hpp"

namespace ukemi::identify {

/// What was fitted, and how.
struct Experiment {
  const Rig& rig;
  const std::vector<Trial>& trials;
  FitOptions options;
  void validate(const Fit& fit) const;  ///< throws InputError, also where `fit` is not of these trials
};

/// The score test of a term that the fit lacks: the slope of the cost at the term's absence, the fitted terms
/// following, in its own standard deviation; of a term that each trial has, all of them at once. Needs no fit of the
/// term.
struct ScoreTest {
  std::string term;
  Scope scope = Scope::kShared;
  double statistic = 0;  ///< chi-squared where the term is absent; 0 where the slope wants a term below 0 that is not
  int degrees = 1;       ///< of freedom: 1, or as many as there are trials
  double z = 0;          ///< its signed root, of a term that all trials share
  double p = 1;          ///< one-sided where the absence is the bound
  double size = 0;       ///< first estimate, linear; the largest of a term that each trial has [its unit]
  double gain = 0;       ///< by which the cost would fall: linear, or of a fit, see test_residuals [rad^2]
  /// By how many of its standard errors the most affected constant is off for each standard error by which the term, of
  /// all trials, differs from its absence: what goes undetected at 3 standard errors does thrice this.
  double bias = 0;
  bool rejected = false;  ///< that the term is absent, see test_residuals
};

/// Sums over parts of the logs of [J T L r]' [J T L r]: derivatives of the residuals r by what was fitted and is off
/// its bounds, by the absent terms that all trials share, and by those that each has; a trial's own fitted terms
/// eliminated.
struct Score {
  std::vector<Eigen::MatrixXd> parts;  ///< trial by trial
  int parts_of_trial = 1;              ///< as many for each, so that there are well more parts than parameters
  std::vector<Term> shared, of_trial;  ///< absent terms
  std::vector<int> free;               ///< what J is by: indices of Fit::fitted
  Eigen::MatrixXd information;         ///< J' J and the priors'
  Eigen::VectorXd slope;               ///< J' r and the priors': 0 at the minimum
  double variance = 0;                 ///< of a residual

  int parameters() const { return int(free.size()); }
  int trials() const { return int(parts.size()) / parts_of_trial; }
};

/// None where the fit has no minimum to look at, or every constant stands at a bound.
[[nodiscard]] std::optional<Score> score_of(const Experiment& experiment, const Fit& fit);

/// Tests every term of the table that the fit lacks; those that what was fitted can do all of are left out.
[[nodiscard]] std::vector<ScoreTest> score_tests_of(const Score& score);

/// Covariance of what was fitted [score.free], whatever the correlation within each part: the delete-one-part jackknife
/// in its linear form (a sandwich estimate of the kind HC3),
///
///     (C - 1) / C sum_c d_c d_c',   d_c = (H - H_c)^-1 g_c,   H = sum_c H_c = J' J,   g_c = J_c' r_c.
[[nodiscard]] Eigen::MatrixXd sandwich(const Score& score);

}  // namespace ukemi::identify

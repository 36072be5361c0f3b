// Tests from the residuals' derivatives at a fit's minimum, by fitted and by absent terms: score tests of every term
// that the fit could have, and errors that are robust to correlated residuals.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "identify/fit/sensitivity.hpp"

namespace ukemi::identify {

/// The experiment without the rig's errors, for fits that are only compared.
inline Experiment noise_only(Experiment experiment) {
  experiment.options.errors = FitOptions::Errors::kNoiseOnly;
  return experiment;
}

/// The score test of a term that the fit lacks: the gradient of the cost at the term's absent value, with the fitted
/// terms eliminated, in standard deviations; of a per-trial term, of all trials at once. Needs no fit of the term.
struct ScoreTest {
  std::string term;
  Scope scope = Scope::kShared;
  double statistic = 0;  ///< chi-squared where the term is absent; 0 where the gradient points out of its bound
  int degrees = 1;       ///< of freedom: 1, or as many as there are trials
  double z = 0;          ///< signed root of `statistic`, of a shared term
  double p = 1;          ///< one-sided where the absent value is the bound
  double size = 0;       ///< linear estimate of the term; the largest of a per-trial one [its unit]
  double gain = 0;       ///< predicted decrease of the cost: linear, or by a fit, see test_residuals [rad^2]
  /// Bias of the most affected constant, in its standard errors, per standard error of the term (shared ones) from its
  /// absent value: a term that goes undetected at 3 standard errors causes three times this.
  double bias = 0;
  bool rejected = false;  ///< the hypothesis that the term is absent, see test_residuals
};

/// A fit is also started from this multiple of a score test's estimate: dry friction has spurious minima near 0.
inline constexpr double kFarFromAbsence = 4;

/// The sensitivity of any least-squares problem at a minimum. Its globals are the fitted ones, in the order of
/// Estimates::fitted, then `shared`, at their absent values; its locals those of each block, then `per_trial`. None
/// where a block cannot be evaluated.
[[nodiscard]] std::optional<Sensitivity> score_at(const LeastSquaresProblem& problem, const Estimates& fit,
                                                  const std::vector<Term>& shared, const std::vector<Term>& per_trial,
                                                  double huber = 0);

/// The sensitivity by every term that the fit lacks. None where the fit has no minimum.
[[nodiscard]] std::optional<Sensitivity> score_of(const Experiment& experiment, const Fit& fit);

/// Tests every term of the table that the fit lacks, except those whose effect the fitted parameters have.
[[nodiscard]] std::vector<ScoreTest> score_tests_of(const Sensitivity& score);

/// p of Chow's test in its linear form, for each trial: of such a gain by constants of its own, where one set serves
/// all trials. Empty with one trial.
[[nodiscard]] std::vector<double> chow_tests_of(const Sensitivity& score);

/// Covariance of the fitted parameters [score.free], robust to any correlation within each part: the delete-one-part
/// jackknife in its linear form (a sandwich estimate of the kind HC3),
///
///     (C - 1) / C sum_c d_c d_c',   d_c = (H - H_c)^-1 g_c,   H = sum_c H_c = J' J,   g_c = J_c' r_c.
[[nodiscard]] Eigen::MatrixXd sandwich(const Sensitivity& score);

}  // namespace ukemi::identify

// The residuals at a fit's minimum and how they move with what was fitted, and with what was not: score tests of every
// term that the fit could carry, and errors that do not take each sample for news.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "identify/fit/sensitivity.hpp"

namespace ukemi::identify {

/// An experiment without the rig's errors: for fits that are only compared.
inline Experiment of_noise(Experiment experiment) {
  experiment.options.errors = FitOptions::Errors::kOfNoise;
  return experiment;
}

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

/// A fit is tried from so many times the size that a score test estimates, too: dry friction has minima of its own near
/// 0.
inline constexpr double kFarFromAbsence = 4;

/// Of any least-squares problem at a minimum. Its globals are those that were fitted, in the order of
/// Estimates::fitted, then `shared`, at their absence; its locals so with those of each block, `of_trial`. None where a
/// block cannot be evaluated. Whatever fits a table of terms is tested by this.
[[nodiscard]] std::optional<Sensitivity> score_at(const LeastSquaresProblem& problem, const Estimates& fit,
                                                  const std::vector<Term>& shared, const std::vector<Term>& of_trial,
                                                  double huber = 0);

/// By every term that the fit lacks. None where the fit has no minimum to look at.
[[nodiscard]] std::optional<Sensitivity> score_of(const Experiment& experiment, const Fit& fit);

/// Tests every term of the table that the fit lacks; those that what was fitted can do all of are left out.
[[nodiscard]] std::vector<ScoreTest> score_tests_of(const Sensitivity& score);

/// Chow's test in its linear form, of each trial: the probability that it asks so much for constants of its own, the
/// others following, where one set serves all. Empty with one trial.
[[nodiscard]] std::vector<double> chow_tests_of(const Sensitivity& score);

/// Covariance of what was fitted [score.free], whatever the correlation within each part: the delete-one-part jackknife
/// in its linear form (a sandwich estimate of the kind HC3),
///
///     (C - 1) / C sum_c d_c d_c',   d_c = (H - H_c)^-1 g_c,   H = sum_c H_c = J' J,   g_c = J_c' r_c.
[[nodiscard]] Eigen::MatrixXd sandwich(const Sensitivity& score);

}  // namespace ukemi::identify

// Tests of a fit's model by its residuals: whether they are white and normal, whether the model lacks a term, and
// whether a trial disagrees with the others. With a correct model, all tests of the residuals together raise a false
// alarm with probability kTestLevel.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identify/estimate/estimates.hpp"
#include "identify/trust/score.hpp"

namespace ukemi::identify {

/// Probability of a false alarm of all tests of the residuals together, and of each test of --diagnose.
inline constexpr double kTestLevel = 0.01;

/// Residuals of one output of one trial, whitened but not weighted, and its log.
struct ResidualSeries {
  std::vector<double> residual;
  const std::vector<double>* measured;
};
[[nodiscard]] std::vector<ResidualSeries> residual_series(const Fit& fit, const std::vector<Trial>& trials);

/// Ljung and Box's test over the lags 1 .. kWhitenessLags, the statistics of all trials and outputs summed. With
/// coloured residuals the standard errors, which assume independent samples, are too small. A log that is quantised
/// more coarsely than its residual is left out, and score tests then count correlated samples as one.
struct Whiteness {
  double p = 1;
  double correlation = 0;  ///< of neighbouring residuals, the mean over the trials
  bool rejected = false;   ///< see test_residuals
};
inline constexpr int kWhitenessLags = 20;
[[nodiscard]] Whiteness whiteness(const std::vector<ResidualSeries>& series);

/// Jarque and Bera's test, each trial's residuals in units of their standard deviation. Coarse logs are left out:
/// their residuals are not normal, whatever the model.
struct Normality {
  double p = 1;
  double skewness = 0, kurtosis = 0;  ///< kurtosis of the normal distribution: 0
  int coarse = 0;                     ///< logs left out
  int tested = 0;
  bool rejected = false;  ///< see test_residuals
};
[[nodiscard]] Normality normality(const std::vector<ResidualSeries>& series);

/// The tests of a fit's residuals: whiteness, normality, and the score test of every term that the fit lacks. Holm's
/// procedure over all of them decides which are rejected. Where several terms are, their gains are computed by fits.
struct ResidualTests {
  Whiteness whiteness;
  Normality normality;
  std::vector<ScoreTest> score_tests;
  double samples = 0;                ///< number of measurements
  double inflation = 1;              ///< factor on the variance of a sum over residuals, where logs are coarse
  std::vector<double> chow;          ///< p of each trial's, see chow_tests_of; empty: not tested
  std::optional<Sensitivity> score;  ///< where the fit has a minimum to look at

  /// Whether the model does not explain the logs: the residuals are not white, a term is missing, or a trial disagrees
  /// with the others.
  bool model_rejected() const;
  /// Whether trial m disagrees with the others by `chow`, at kTestLevel over all trials.
  bool disagrees(std::size_t m) const { return chow[m] * double(chow.size()) < kTestLevel; }
  /// Gain in BIC: the decrease of cost / variance by a term, less log(samples) for each of its parameters.
  double worth(const ScoreTest& test) const;
  /// Of the terms whose absence is rejected, the one of largest `worth`; null where none is.
  const ScoreTest* missing() const;
  /// rms of the residuals with that term, to first order [rad].
  double rms_with(const ScoreTest& test) const;
};
/// The tests of any least-squares fit; gains are linear.
[[nodiscard]] ResidualTests test_residuals(const std::vector<ResidualSeries>& series, std::optional<Sensitivity> score);
/// The tests of a fit of trials.
[[nodiscard]] ResidualTests test_residuals(const Experiment& experiment, const Fit& fit);

/// Where the model is rejected or logs are coarse: standard errors and intervals from the sandwich estimate wherever it
/// is wider (those of a trial's own terms by the largest such factor). No constant of a rejected model is trusted.
void widen_errors(const ResidualTests& tests, Estimates& fit);
/// Also distrusts a fit that did not converge, is far above the noise, or has flawed logs.
void widen_errors(const ResidualTests& tests, Fit& fit);

/// The fit without one of its trials.
struct LeftOut {
  std::string file;
  Fit fit;                    ///< of the others
  std::vector<double> shift;  ///< of each constant, in standard errors of the whole fit; NaN where there is none
  double held_out = 0;  ///< rms of the trial's residual under that fit, its own terms fitted [rad]; NaN: no rollout
  /// p of Chow's test that one set of constants serves this trial and the others, by the likelihood ratio of separate
  /// fits to the joint one.
  double p = 1;
  bool disagrees = false;  ///< p below kTestLevel / number of trials
};
/// Leaves out each trial in turn, on `threads` threads (0: all); empty for fewer than two trials.
[[nodiscard]] std::vector<LeftOut> leave_one_out(const Experiment& experiment, const Fit& fit, int threads = 1);

// --- shared by the ladder and the profile ---

/// The trials but for one.
[[nodiscard]] std::vector<Trial> without(std::vector<Trial> trials, std::size_t one);

/// A fit from the single start `from`; what is not fitted keeps its values there.
[[nodiscard]] Fit refit(const Rig& rig, const std::vector<Trial>& trials, const SeaParameters<double>& from,
                        FitOptions options);

/// -2 log-likelihood of normal residuals of unknown variance, one for all trials or, with weights by trial, one each;
/// robust where the fit is. Up to a constant of the data.
[[nodiscard]] double deviance(const Fit& fit, const std::vector<Trial>& trials, const FitOptions& options);

/// rms of a trial's residual with the constants and shared terms of `fit`, the trial's own terms fitted; NaN where the
/// rollout fails [rad].
[[nodiscard]] double held_out_rms(const Rig& rig, const Trial& trial, const Fit& fit, const FitOptions& options);

}  // namespace ukemi::identify

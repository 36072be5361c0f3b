// What the residuals of a fit say of its model: whether they are white and normal, whether they ask for a term that the
// model lacks, and whether a trial disagrees with the others. Each test has the same level: with nothing wrong it
// speaks up that often.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identify/fit.hpp"

namespace ukemi::identify {

/// Probability of a false alarm of each test.
inline constexpr double kTestLevel = 0.01;

/// What was fitted, and how.
struct Experiment {
  const Rig& rig;
  const std::vector<Trial>& trials;
  FitOptions options;
};

/// Ljung and Box's test over the lags 1 .. kWhitenessLags, the statistics of all trials and outputs summed. Coloured
/// residuals: the standard errors, which take every sample for news, are too small.
struct Whiteness {
  double p = 1;
  double correlation = 0;  ///< of neighbouring residuals, the mean over the trials
  bool rejected() const { return p < kTestLevel; }
};
inline constexpr int kWhitenessLags = 20;
[[nodiscard]] Whiteness whiteness(const Fit& fit, const std::vector<Trial>& trials);

/// Jarque and Bera's test, each trial's residuals in units of its own standard deviation. A log that is quantised more
/// coarsely than its residual is left out: its residuals are not normal, whatever the model.
struct Normality {
  double p = 1;
  double skewness = 0, kurtosis = 0;  ///< kurtosis of the normal distribution: 0
  int coarse = 0;                     ///< logs left out
  int tested = 0;
  bool rejected() const { return p < kTestLevel; }
};
[[nodiscard]] Normality normality(const Fit& fit, const std::vector<Trial>& trials);

/// An optional term of the model; 0, its bound, is its absence.
struct LadderTerm {
  NuisanceTerm term;
  double SeaParameters<double>::*value;
};
inline constexpr LadderTerm kLadderTerms[] = {{NuisanceTerm::kFriction, &SeaParameters<double>::friction},
                                              {NuisanceTerm::kStiffening, &SeaParameters<double>::k_sea_cubic}};

/// A term that the model lacks, by the score test: the slope of the cost at 0 of the term, the fitted ones following,
/// in its own standard deviation; one-sided, for the term is not below 0. Needs no fit.
struct Lack {
  std::string term, unit;
  double z = 0;  ///< standard normal where the term is absent; large where it would help
  double p = 1;
  double size = 0;  ///< first estimate of the term, linear [its unit]
};
struct Lacks {
  std::vector<Lack> terms;
  /// The term that is missed most, where one is at kTestLevel, which the terms that were tested share.
  const Lack* missed() const;
};
/// Tests the terms of the ladder that are absent. Empty where the fit has no minimum to test at.
[[nodiscard]] Lacks lacks(const Experiment& experiment, const Fit& fit);

/// The fit without one of its trials.
struct LeftOut {
  std::string file;
  Fit fit;                    ///< of the others
  std::vector<double> shift;  ///< of each constant, in standard errors of the whole fit; NaN where there is none
  double held_out = 0;  ///< rms of the trial's residual under that fit, its own terms fitted [rad]; NaN: no rollout
  /// Of Chow's test, that one set of constants serves this trial and the others, by the log-likelihood of both fitted
  /// apart against together.
  double p = 1;
  bool disagrees = false;  ///< p below kTestLevel / number of trials
};
/// Each trial in turn, on `threads` threads (0: all); two trials at least, else nothing.
[[nodiscard]] std::vector<LeftOut> leave_one_out(const Experiment& experiment, const Fit& fit, int threads = 1);

// --- what the ladder and the profile share ---

/// The trials but for one.
[[nodiscard]] std::vector<Trial> without(std::vector<Trial> trials, std::size_t one);

/// A fit from one start, where another ended; what is not fitted stays as it is there.
[[nodiscard]] Fit refit(const Rig& rig, const std::vector<Trial>& trials, const SeaParameters<double>& from,
                        FitOptions options);

/// -2 log-likelihood of normal residuals of unknown variance, one for all trials or, with weights by trial, one each;
/// robust where the fit is. Up to a constant of the data.
[[nodiscard]] double deviance(const Fit& fit, const std::vector<Trial>& trials, const FitOptions& options);

/// rms of a trial's residual with the constants and shared terms of `fit`, the trial's own terms fitted; NaN where the
/// rollout fails [rad].
[[nodiscard]] double held_out_rms(const Rig& rig, const Trial& trial, const Fit& fit, const FitOptions& options);

}  // namespace ukemi::identify

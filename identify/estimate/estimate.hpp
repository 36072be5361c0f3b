// What a fit found: estimates with standard errors, 95 % intervals and verdicts, and where the errors come from.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/uncertainty.hpp"

namespace ukemi::identify {

/// How far a constant may be relied on. The verdicts of every fit are made here.
enum class Identifiability {
  kTrusted,          ///< the 95 % interval is at most kTrustedWidth of the value either way
  kWeak,             ///< at most kWeakWidth, or the residual stays far above the logs' noise
  kNotIdentifiable,  ///< wider, or not determined at all
  kAtBound,
  kFixed,   ///< not fitted
  kFitted,  ///< a nuisance term, without a verdict
};
const char* name(Identifiability identifiability);

/// Largest half widths of the 95 % interval, as fractions of the value.
inline constexpr double kTrustedWidth = 0.1, kWeakWidth = 0.5;

/// A residual this many times the logs' own noise is far above it: the minimum may be a bad one, or the model wrong.
inline constexpr double kFarAboveNoise = 1.5;

struct Estimate {
  std::string name, unit;
  double value = 0;
  std::optional<double> std;  ///< standard error; absent where it cannot be estimated (fixed, at a bound, undetermined)
  std::optional<double> std_noise = {};  ///< the part of it that is the logs' noise; the rest: Considered
  double ci_low = 0, ci_high = 0;        ///< 95 %, with `std`
  bool at_bound = false, free = true;
  int trial = -1;                                     ///< of a nuisance term that each trial has for itself; -1: shared
  Identifiability verdict = Identifiability::kFixed;  ///< of a constant
  double judged_size = 0;                             ///< Term::judged_size of a constant

  double half_width() const { return (ci_high - ci_low) / 2; }  ///< of the 95 % interval, with `std`
  /// What a constant's interval is measured against.
  double size() const { return std::max(std::abs(value), judged_size); }
};

/// Whether every constant that was fitted is trusted.
[[nodiscard]] bool all_trusted(const std::vector<Estimate>& parameters);

/// A term that was not fitted, or ended at a bound, whose value has the standard deviation s (a consider parameter of
/// orbit determination). With J of what was fitted and j of the term, at the minimum,
///
///     dtheta / dterm = d = -(J' W J)^-1 J' W j,   covariance = that of noise + s^2 d d'.
struct Considered {
  std::string name;
  double std = 0;     ///< s [the term's unit]
  DenseMatrix shift;  ///< s d, by row as Estimates::fitted; a column for each independent draw of the term
};

/// The combination of constants that the data determine least: the eigenvector of the smallest eigenvalue of the Fisher
/// information of their logarithms, all other terms eliminated.
struct Weakest {
  std::vector<std::pair<std::string, double>> change;  ///< relative change of each constant, largest first
  double rms = 0;    ///< by which this change moves the predictions, root mean square [as the residuals]
  double noise = 0;  ///< the residuals' own standard deviation [same]
};
/// `data` as in "trials", `outputs` as in "the angles", `unit` of those.
std::string in_words(const Weakest& weakest, const std::string& data, const std::string& outputs,
                     const std::string& unit);

/// The result of a fit, whatever it fits.
struct Estimates {
  std::vector<Estimate> parameters;  ///< every constant of the table, in its order, fitted or not
  std::vector<Estimate> nuisance;    ///< shared, then term by term those of each trial
  std::vector<std::string> fitted;   ///< order of `covariance`: free constants, then shared terms
  /// Of noise and considered terms together; NaN where not determined.
  DenseMatrix covariance, correlation;
  DenseMatrix noise_covariance;        ///< the part of it that is the logs' noise
  std::vector<Considered> considered;  ///< uncertain terms that were not fitted, or ended at a bound
  std::vector<double> eigenvalues;     ///< of the scaled information, ascending, largest 1
  double half_width = kNormal975;      ///< 95 % interval in standard errors (Student's t)
  std::optional<Weakest> weakest;      ///< the combination that the data determine least
  double cost = 0;                     ///< the sum of squares; weighted or robust as the options say
  bool converged = false;
  int iterations = 0;   ///< of the best start
  int starts = 0;       ///< how many were run
  std::string message;  ///< why it did not converge, or that it was interrupted
  std::vector<std::string> warnings;

  /// Whether it converged and every fitted constant is trusted.
  bool trusted() const { return converged && all_trusted(parameters); }
  /// What was fitted for all trials, in the order of `fitted`.
  std::vector<const Estimate*> globals() const;
};

/// Where a constant's variance comes from.
struct ErrorBudget {
  std::string constant;
  std::vector<std::pair<std::string, double>> shares;  ///< "noise", then each Considered: parts of the variance, sum 1
};
/// Of every constant that has a standard error.
[[nodiscard]] std::vector<ErrorBudget> error_budget(const Estimates& estimates);

}  // namespace ukemi::identify

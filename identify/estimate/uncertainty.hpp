// How far the result of a least-squares fit can be relied on: standard errors, 95 % intervals, a verdict for each
// constant, and the direction in which the data say least.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "identify/estimate/least_squares.hpp"

namespace ukemi::identify {

/// How far a constant may be relied on. The verdicts of every fit are made here.
enum class Identifiability {
  kTrusted,          ///< the 95 % interval is at most kTrustedWidth of the value either way
  kWeak,             ///< at most kWeakWidth, or the residual stays far above the logs' noise
  kNotIdentifiable,  ///< wider, or not determined at all
  kAtBound,
  kFixed,   ///< not fitted
  kFitted,  ///< along with the constants: no constant, not judged
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
  int trial = -1;                                     ///< of a nuisance term that each trial has; -1: one for all
  Identifiability verdict = Identifiability::kFixed;  ///< of a constant
  double judged_size = 0;                             ///< Term::judged_size of a constant

  double half_width() const { return (ci_high - ci_low) / 2; }  ///< of the 95 % interval, with `std`
  /// What a constant's interval is measured against.
  double size() const { return std::max(std::abs(value), judged_size); }
};

/// What a parameter came to, at its bound where the value is.
[[nodiscard]] Estimate estimate_of(const Parameter& parameter, double value, double variance, double half_width,
                                   int trial = -1);
/// Standard error and 95 % interval from the whole variance, and its part of the noise; none where it is not a number.
void set_error(Estimate& e, double variance, double of_noise, double half_width);

/// A term that was not fitted and is known but for its standard deviation s (a considered parameter of orbit
/// determination). With J of what was fitted and j of the term, at the minimum,
///
///     theta follows the term by  d = -(J' W J)^-1 J' W j,   covariance = that of noise + s^2 d d'.
struct Considered {
  std::string name;
  double std = 0;         ///< s [the term's unit]
  Eigen::MatrixXd shift;  ///< s d, by row as Estimates::fitted; a column for each independent draw of the term
};

/// The verdict by the widths above.
[[nodiscard]] Identifiability judge(const Estimate& e);

/// Whether every constant that was fitted is trusted.
[[nodiscard]] bool all_trusted(const std::vector<Estimate>& parameters);

/// Where the residual is far above the noise the model does not explain the logs, and its error bars mean little:
/// what was trusted is weak.
void distrust(std::vector<Estimate>& parameters);

/// The combination of constants that the data know least: the eigenvector of the smallest eigenvalue of the Fisher
/// information of their logarithms, all other terms fitted along.
struct Weakest {
  std::vector<std::pair<std::string, double>> change;  ///< relative change of each constant, largest first
  double rms = 0;    ///< by which this change moves the predictions, root mean square [as the residuals]
  double noise = 0;  ///< the residuals' own standard deviation [same]
};
/// `data` as in "trials", `outputs` as in "the angles", `unit` of those.
std::string in_words(const Weakest& weakest, const std::string& data, const std::string& outputs,
                     const std::string& unit);

/// Of a solution whose residuals have this variance; `sizes` are those of the constants, its first globals. None where
/// fewer than two are off their bounds. The step is as far as `half_width` standard errors reach along it.
[[nodiscard]] std::optional<Weakest> weakest_of(const LeastSquaresSolution& solution,
                                                const LeastSquaresProblem& problem, const std::vector<double>& sizes,
                                                double variance, double half_width);

}  // namespace ukemi::identify

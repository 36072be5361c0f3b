// Measures of a distribution of peaks: mean, mean of the worst part, quantiles; and their standard errors.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace ukemi::landing {

/// The measure that a plan under scatter minimises.
struct Measure {
  enum class Kind {
    kMean,
    kCvar,      ///< the mean of the worst 1 - level of all drops (Rockafellar, Uryasev 2000)
    kQuantile,  ///< below which a share `level` of all drops stays
    kWorst,     ///< of the drops that were played
  } kind = Kind::kMean;
  double level = 0.9;  ///< of kCvar and kQuantile, between 0 and 1
  /// Share of drops in which a plan must keep the limits: all that the measure depends on; half for the mean. With more
  /// broken ones its value would be the penalty, not an acceleration.
  double share() const { return kind == Kind::kMean ? 0.5 : kind == Kind::kWorst ? 1 : level; }

  void validate() const;  ///< throws InputError for a level outside
  /// The measure of the peaks, which are reordered. NaN where there are none.
  double of(std::span<double> peaks) const;
  /// Parses "mean", "cvar", "quantile:Q" or "worst". Throws InputError "OPTION: ...".
  static Measure parse(const std::string& option, const std::string& text);
  std::string name() const;
};

/// A value and its standard error from the number of independent drops alone (smaller for Sobol points). NaN where it
/// cannot be estimated.
struct Estimated {
  double value, standard_error;
};
Estimated estimated(const Measure& measure, std::span<const double> peaks);

/// Peaks over scattered drops [m/s^2].
struct Distribution {
  Estimated mean, cvar90;  ///< cvar90: the mean of the worst tenth
  Estimated median, q90, q99;
  double max;
  long samples = 0;
};
Distribution distribution(std::span<const double> peaks);

/// Drops with a peak from `lower` to below `upper` [m/s^2].
struct PeakBin {
  double lower, upper;
  long drops = 0, beside = 0;  ///< of the motion; of the one it is compared with
};
/// Bins whose width is a power of two: 32 to 64 from the smallest peak of the motion to its 99th percentile `q99`, and
/// not more than 512 over both. Throws InputError for numbers that are not finite.
std::vector<PeakBin> histogram(std::span<const double> peaks, std::span<const double> beside, double q99);

}  // namespace ukemi::landing

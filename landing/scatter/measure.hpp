// What a distribution of peaks is worth: its mean, its worst part, its quantiles; and its standard error.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace ukemi::landing {

/// What a plan under scatter makes small.
struct Measure {
  enum class Kind {
    kMean,
    kCvar,      ///< the mean of the worst 1 - level of all drops (Rockafellar, Uryasev 2000)
    kQuantile,  ///< what `level` of all drops stay below
    kWorst,     ///< of the drops that were played
  } kind = Kind::kMean;
  double level = 0.9;  ///< of kCvar and kQuantile, between 0 and 1
  /// Of all drops, in so many a plan for it must keep the limits: all that it looks at; for the mean half. In more
  /// broken ones its value would be the penalty and no acceleration.
  double share() const { return kind == Kind::kMean ? 0.5 : kind == Kind::kWorst ? 1 : level; }

  void validate() const;  ///< throws InputError for a level outside
  /// The measure of the peaks, which it reorders. NaN where there are none.
  double of(std::span<double> peaks) const;
  /// mean, cvar, quantile:Q, worst, as options have them. Throws InputError "OPTION: ...".
  static Measure parse(const std::string& option, const std::string& text);
  std::string name() const;
};

/// A value and the standard error that it has from the number of drops alone (of independent ones; even ones do
/// better). NaN where there is no telling.
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
  long drops = 0, beside = 0;  ///< of a motion, of what it is compared with
};
/// Bins whose width is a power of two: 32 to 64 from the smallest peak of the motion to its 99th percentile `q99`, and
/// not more than 512 over both. Throws InputError for numbers that are not finite.
std::vector<PeakBin> histogram(std::span<const double> peaks, std::span<const double> beside, double q99);

}  // namespace ukemi::landing

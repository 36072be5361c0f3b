// Robustness of a motion: the width of its basin, and the effect of small deviations on its peak.
#pragma once

#include <array>
#include <vector>

#include "common/monitor.hpp"
#include "landing/run/work.hpp"
#include "landing/search/tolerant_peak.hpp"

namespace ukemi::landing {

struct EvidenceOptions {
  double accuracy = 1e-9;     ///< of the landings
  int tolerance_samples = 0;  ///< random points inside the execution box
  std::uint64_t seed = 1;     ///< of these points
  int threads = 0;            ///< 0: all cores; without influence on the result
  long work = kCheckWork;     ///< maximum, see work_of and Evidence::complete
  Monitor monitor;            ///< progress in landings
  void validate() const;      ///< throws InputError
};

/// The peak when one thing at a time is not as planned; infinite where a landing could not be followed, NaN where it
/// was not played.
struct Evidence {
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  double peak = 0;  ///< of the motion [m/s^2]
  /// How far each variable of the motion space may decrease and increase, in its unit, before the peak rises by kRise;
  /// at most to the end of its range.
  std::vector<std::array<double, 2>> width;
  double one_degree = kUnknown;           ///< worst peak with the angles off by 0 or 1 deg either way [m/s^2]
  double ten_milliseconds = kUnknown;     ///< with the duration off by 10 ms either way
  double one_centimetre = kUnknown;       ///< with the drop's height off by 1 cm either way
  double pitch_one_degree = kUnknown;     ///< with the drop's pitch off by 1 deg either way
  double damping_ten_percent = kUnknown;  ///< with both of the floor's damping constants off by 10 % either way
  TolerantPeak tolerant;                  ///< within the scene's execution tolerance
  /// False where it was stopped, or where EvidenceOptions::work was exhausted or too little for kLandings landings as
  /// long as the motion's.
  bool complete = false;
  long work = 0;  ///< estimated, or done where that is more, see work_of
  static constexpr double kRise = 0.05;
  static constexpr long kLandings = 420;
};

/// Computes the deviations, then the widths. A width is found on a geometric grid from 1e-7 of the range, then refined
/// between its last good and first bad point: it is that of the connected part around the motion.
[[nodiscard]] Evidence evidence(const Scene& scene, const MotionSpace& space, const Coordinates& values,
                                const EvidenceOptions& options);
/// The evidence of a motion of Eq. 6.
[[nodiscard]] Evidence evidence(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                                const EvidenceOptions& options);

}  // namespace ukemi::landing

// What a motion of a robot of links does over drops that scatter, beside the posture that is held.
#pragma once

#include <optional>

#include "landing/judge/risk.hpp"
#include "landing/plan/body_drops.hpp"

namespace ukemi::landing {

struct BodyRiskOptions {
  long samples = 10'000;           ///< drops that are drawn: scrambled Sobol points; 1 to 10,000,000
  std::optional<Scatter> scatter;  ///< see scatter_for
  BodyDropModel::Options drops;
  std::uint64_t seed = 1;
  int threads = 0;        ///< 0: all cores; without influence on the results
  Monitor monitor;        ///< told of the landings; what it stops is of the drops that were played until then
  void validate() const;  ///< throws InputError
};

struct BodyRisk : PeakRisk {
  Scatter scatter;
  bool assumed = false;  ///< nobody said what the scatter is
  long broken = 0;       ///< of the drops that were followed, those in which a limit is broken
  /// Of them the share that keeps every limit; NaN: none was followed.
  double kept() const { return 1 - double(broken) / double(peaks.samples); }
};

/// Plays a motion, and the held posture, over the drops of a scene; for Sobol's indices about as many landings again.
/// Events are the passings of each joint's ratings and of each load's. Same inputs and seed, same results. Throws
/// InputError as BodyDropModel and `simulate`. Tests: test/legs/scatter.cpp.
[[nodiscard]] BodyRisk body_risk(const BodyScene& scene, const BodyMotion& motion, const BodyRiskOptions& options = {});

}  // namespace ukemi::landing

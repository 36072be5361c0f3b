// Drops of a risk, played and counted: for any kind of robot, as one of links.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "landing/body/body_run.hpp"
#include "landing/judge/risk.hpp"
#include "landing/scatter/sampler.hpp"

namespace ukemi::landing {

/// A drop to be played: its scene, without loads, and motions as they are executed in it.
struct PlayableDrop {
  BodyScene scene;
  BodyMotion motion, held;
  bool from_floor = false;
};

struct RiskRun {
  const Robot& robot;
  std::vector<RiskEvent> events;
  std::vector<Load> loads;  ///< of each event the load that is beyond its rating in it; those with `limit` are limits
  const Sampler& sampler;
  bool flight_counts = true;  ///< a drop that touches nothing until t_end has the peak of its flight, else none
  bool drawn = true;          ///< else measured drops: without indices
  long samples = 0;           ///< number of drops
  long held = 0;              ///< of these, the first ones in which the held reference is played too
  std::uint64_t seed = 1;
  int threads = 0;
  const Monitor& monitor;
  std::function<std::vector<PlayableDrop>(long first, long count)> drops;
  /// Drops at `count` points of the sampler's cube.
  std::function<std::vector<PlayableDrop>(const std::vector<double>& points, long count)> at;

  /// Plays all drops and, where they are drawn and two groups scatter or more, those of Sobol's indices; sets all of
  /// `out`. Returns the highest peaks with the indices of their drops, at most Risk::kWorst, the worst first.
  std::vector<std::pair<double, long>> play(PeakRisk& out) const;
};

}  // namespace ukemi::landing

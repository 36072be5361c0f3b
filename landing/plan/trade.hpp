// What a number of a design buys: the best landing for each of its values. Ours.
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "landing/plan/body_plan.hpp"

namespace ukemi::landing {

struct TradeAxis {
  std::string name;            ///< of design_names
  std::vector<double> values;  ///< at least two, rising, in the unit of its key
};

/// A design, and what it is worth by the goal of the plans [m/s^2]. At least kNoMotion: some landing could not be
/// followed, the limits are not kept, or the trade was stopped before.
struct TradePoint {
  static constexpr double kNone = std::numeric_limits<double>::infinity();
  std::vector<double> at;    ///< a value of each axis
  double held = kNone;       ///< of the held posture
  double unchanged = kNone;  ///< of the motion that is planned for the middle design
  double planned = kNone;    ///< of `motion`
  double peak = kNone;       ///< of `motion`, in the scene's own drop
  BodyMotion motion;         ///< the best that was found for this design; holding where nothing was better
  Edges edges{};             ///< of the ranges that it lies on
  bool found() const { return !motion.empty(); }
};

struct TradeOptions {
  /// Of each plan; without a deadline. `starts`, `rate`, `fresh` and `monitor` have no meaning.
  BodyPlanOptions search;
  std::function<void(BodyScene&)> prepare;  ///< last, of each design's scene, as respect_ratings
  Monitor monitor;                          ///< plans done, of how many at least; stopped: what is planned so far
};

struct Trade {
  std::vector<TradeAxis> axes;
  std::vector<TradePoint> points;  ///< the last axis changes first
  std::size_t middle = 0;          ///< index of the middle design
  long plans = 0;
};

/// Plans the middle design, then every other from the motions of its neighbours, forward and back, until no neighbour's
/// motion is better than a design's own. One or two axes. Throws InputError for a name that is none, a value outside of
/// its range, or an axis that does not rise. Tests: test/legs/trade.cpp.
[[nodiscard]] Trade trade(const BodyScene& scene, const std::vector<TradeAxis>& axes, const TradeOptions& options);

}  // namespace ukemi::landing

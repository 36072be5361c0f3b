// What a number of a design buys: the best landing for each of its values. Ours.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "landing/plan/body_plan.hpp"

namespace ukemi::landing {

struct TradeAxis {
  std::string name;            ///< of design_names
  std::vector<double> values;  ///< at least two, rising, in the unit of its key
};

/// A design, and what it is worth by the goal of the plans [m/s^2]. kNoMotion: some landing could not be followed,
/// or the limits are not kept.
struct TradePoint {
  std::vector<double> at;  ///< a value of each axis
  double held = 0;         ///< of the held posture
  double unchanged = 0;    ///< of the motion that is planned for the middle design
  double planned = 0;      ///< of `motion`
  double peak = 0;         ///< of `motion`, in the scene's own drop
  BodyMotion motion;       ///< the best that was found for this design; holding where nothing was better
  Edges edges{};           ///< of the ranges that it lies on
  bool found = false;
  bool neighbours = false;  ///< the motion comes from that of a neighbour
};

struct TradeOptions {
  BodyPlanOptions search;  ///< of each plan; without a deadline. `starts`, `rate` and `fresh` have no meaning
  std::function<void(BodyScene&)> prepare;  ///< last, of each design's scene, as respect_ratings
  Monitor monitor;                          ///< plans done, of how many at least
};

struct Trade {
  std::vector<TradeAxis> axes;
  std::vector<TradePoint> points;   ///< the last axis changes first
  std::size_t middle = 0;           ///< index of the middle design
  std::vector<Variable> variables;  ///< of the motions
  long plans = 0;
};

/// Plans the middle design, then every other from the motions of its neighbours, forward and back, until no neighbour's
/// motion is better than a design's own. One or two axes. Throws InputError for a name that is none, a value outside of
/// its range, or an axis that does not rise. Tests: test/legs/trade.cpp.
[[nodiscard]] Trade trade(const BodyScene& scene, const std::vector<TradeAxis>& axes, const TradeOptions& options);

}  // namespace ukemi::landing

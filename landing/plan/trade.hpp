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
  int plans = 0;             ///< that were finished of kPlans: its own, then from what its neighbours found
  static constexpr int kPlans = 2;
  bool found() const { return !motion.empty(); }
};

/// Part `index` of `count` of the designs, one beside the other.
struct TradePart {
  std::size_t index = 0, count = 1;
};

struct TradeOptions {
  /// Of each plan; without a deadline. `starts`, `rate`, `fresh` and `monitor` have no meaning.
  BodyPlanOptions search;
  std::function<void(BodyScene&)> prepare;  ///< last, of each design's scene, as respect_ratings
  /// Points of an earlier call, empty or as many as there are designs, of `pareto` twice as many: plans that were
  /// finished are not made again, and the answer is the same.
  std::vector<TradePoint> known;
  /// Index of a design, one of whose plans is finished; of `pareto` behind the designs what each starts from.
  std::function<void(std::size_t, const TradePoint&)> done;
  TradePart part;
  Monitor monitor;  ///< plans done, of how many at least; stopped: what is planned so far
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

/// What one load costs in another: a trade along the rating of the other.
struct Front {
  BodyScene scene;  ///< `cost` alone is made small, `limited` is a limit
  Trade trade;      ///< its one axis is load.LIMITED.rating
};
/// The smallest value of the load `cost` for each of `count` values that the load `limited` may have, from the smallest
/// that any motion was found for to what the best motion for `cost` alone takes. "peak": the acceleration that counts
/// without loads. A front of one design: no motion that is better for one is worse for the other. Throws InputError as
/// check_front.
[[nodiscard]] Front pareto(const BodyScene& scene, const std::string& cost, const std::string& limited,
                           std::size_t count, const TradeOptions& options);

/// Throws InputError for a name that is no load, of a load that is a touch, or of the same twice.
void check_front(const BodyScene& scene, const std::string& cost, const std::string& limited);

}  // namespace ukemi::landing

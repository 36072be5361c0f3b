// Trade-off studies: the best landing for each value of a design number.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "landing/plan/body_plan.hpp"

namespace ukemi::landing {

struct TradeAxis {
  std::string name;            ///< of design_names
  std::vector<double> values;  ///< at least two, increasing, in the unit of its key
};

/// A design and its values of the plans' goal [m/s^2]; kNoMotion or more: a landing could not be followed, the limits
/// are not kept, or the trade was stopped before.
struct TradePoint {
  std::vector<double> at;        ///< the value of each axis
  double held = kNoMotion;       ///< of the held posture
  double unchanged = kNoMotion;  ///< of the middle design's motion
  double planned = kNoMotion;    ///< of `motion`
  double peak = kNoMotion;       ///< of `motion`, in the scene's own drop
  BodyMotion motion;             ///< the best for this design; the held posture where nothing was better
  Edges edges{};                 ///< edges of the ranges on which `motion` lies
  int plans = 0;                 ///< finished ones of kPlans: its own, then one from its neighbours' motions
  static constexpr int kPlans = 2;
  bool found() const { return !motion.empty(); }
};

/// Part `index` of `count` consecutive parts of the designs.
struct TradePart {
  std::size_t index = 0, count = 1;
};

struct TradeOptions {
  /// Of each plan; `deadline`, `starts`, `rate`, `fresh` and `monitor` are ignored.
  BodyPlanOptions search;
  std::function<void(BodyScene&)> prepare;  ///< applied last to each design's scene, e.g. respect_ratings
  /// Points of an earlier call, none or one for each design (for `pareto` two): finished plans are not repeated, and
  /// the result is the same.
  std::vector<TradePoint> known;
  /// Called with the index of a design after each of its plans; for `pareto` also with its start, at count + index.
  std::function<void(std::size_t, const TradePoint&)> done;
  TradePart part;
  Monitor monitor;  ///< progress in plans, total at least; stopped: the result so far
};

struct Trade {
  std::vector<TradeAxis> axes;
  std::vector<TradePoint> points;  ///< the last axis fastest
  std::size_t middle = 0;          ///< index of the middle design
  long plans = 0;
};

/// Plans the middle design, then every other from the motions of its neighbours, forward and back, until no neighbour's
/// motion is better than a design's own. One or two axes. Throws InputError for a name that is none, a value outside of
/// its range, or an axis that does not increase. Tests: test/legs/trade.cpp.
[[nodiscard]] Trade trade(const BodyScene& scene, const std::vector<TradeAxis>& axes, const TradeOptions& options);

/// Pareto front of two loads: a trade along the rating of one of them.
struct Front {
  BodyScene scene;  ///< `cost` alone is minimised, `limited` is a limit
  Trade trade;      ///< its one axis is load.LIMITED.rating
};
/// The smallest value of the load `cost` for each of `count` ratings of the load `limited`, from the smallest feasible
/// one to the value that the best motion for `cost` alone has. "peak": the acceleration that counts
/// without loads. A front of one design: no motion that is better for one is worse for the other. Throws InputError as
/// check_front.
[[nodiscard]] Front pareto(const BodyScene& scene, const std::string& cost, const std::string& limited,
                           std::size_t count, const TradeOptions& options);

/// Throws InputError "OPTION: ..." for a name that is no load, a load of kind kTouch, or equal names.
void check_front(const BodyScene& scene, const std::string& cost, const std::string& limited,
                 const std::string& option);

}  // namespace ukemi::landing

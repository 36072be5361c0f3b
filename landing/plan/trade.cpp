#include "landing/plan/trade.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "landing/body/load.hpp"
#include "landing/plan/body_goal.hpp"
#include "landing/plan/design_numbers.hpp"

namespace ukemi::landing {

namespace {

/// Options of a single plan of the trade.
BodyPlanOptions plan_options(const TradeOptions& options) {
  BodyPlanOptions out = options.search;
  out.fresh = 0, out.rate = 0, out.deadline.reset(), out.starts.clear();
  out.monitor = {{}, options.monitor.stop};
  return out;
}

class TradePlanner {
 public:
  TradePlanner(const BodyScene& scene, const std::vector<TradeAxis>& axes, const TradeOptions& options, Trade& out)
      : options_(options), out_(out) {
    std::size_t count = 1;
    for (const TradeAxis& axis : axes) count *= axis.values.size();
    out.axes = axes;
    for (std::size_t k = 0; k < count; ++k) {
      TradePoint point;
      BodyScene& s = scenes_.emplace_back(scene);
      for (std::size_t a = 0, rest = count, place = k; a < axes.size(); ++a) {
        rest /= axes[a].values.size();
        point.at.push_back(axes[a].values[place / rest]), place %= rest;
        set_design_number(s, axes[a].name, point.at.back());
      }
      if (options.prepare) options.prepare(s);
      out.points.push_back(std::move(point));
    }
    goals_.resize(count);
    for (const TradeAxis& axis : axes) out.middle = out.middle * axis.values.size() + axis.values.size() / 2;
    first_ = count * options.part.index / options.part.count;
    last_ = count * (options.part.index + 1) / options.part.count;
    for (std::size_t k = 0; k < std::min(count, options.known.size()); ++k) {
      std::vector<double> at = std::move(out.points[k].at);
      if (options.known[k].plans > 0) out.points[k] = options.known[k];
      out.points[k].at = std::move(at);
    }
  }

  /// Gives an unplanned design a motion, accepted where it is better and keeps the limits.
  void add_start(std::size_t k, const BodyMotion& motion, const Edges& edges) {
    if (out_.points[k].plans > 0 || motion.empty()) return;
    if (const double v = value(k, motion); v < out_.points[k].planned) accept(k, motion, v, edges);
  }

  void run() {
    earlier_ = out_.plans;
    const std::size_t middle = std::clamp(out_.middle, first_, last_ - 1);
    plan_at(middle, 1);
    for (std::size_t k = middle + 1; k < last_; ++k) plan_at(k, 1);
    for (std::size_t k = middle; k-- > first_;) plan_at(k, 1);
    for (std::size_t k = first_; k < last_; ++k) plan_at(k, 2);
    while (exchange()) {
    }
    const TradePoint& m = out_.points[out_.middle];
    for (std::size_t k = first_; m.found() && k < last_ && !options_.monitor.stopped(); ++k)
      out_.points[k].unchanged = k == out_.middle ? m.planned : value(k, m.motion);
  }

 private:
  static constexpr double kReplanShare = 0.25;  // of a plan's budget, for a search from the neighbours' motions
  static constexpr double kMinGain = 1e-6;      // relative

  /// Designs one step away along an axis that have a motion.
  std::vector<std::size_t> neighbours(std::size_t k) const {
    std::vector<std::size_t> out;
    std::size_t stride = out_.points.size();
    for (std::size_t a = 0, place = k; a < out_.axes.size(); ++a) {
      const std::size_t count = out_.axes[a].values.size();
      stride /= count;
      const std::size_t i = place / stride;
      place %= stride;
      if (i > 0) out.push_back(k - stride);
      if (i + 1 < count) out.push_back(k + stride);
    }
    std::erase_if(out, [&](std::size_t i) { return !out_.points[i].found(); });
    return out;
  }

  /// Plan `number` (1 or 2) of a design, unless it is finished: from all its neighbours' motions. The second follows
  /// once all neighbours have motions.
  void plan_at(std::size_t k, int number) {
    TradePoint& point = out_.points[k];
    if (point.plans >= number) return;
    search(k, neighbours(k), number == 1 ? 1 : kReplanShare);
    if (options_.monitor.stopped()) return;
    point.plans = number;
    if (options_.done) options_.done(k, point);
  }
  /// Searches from the motions of some designs and its own, with `share` of a plan's budget; accepts a better motion.
  void search(std::size_t k, const std::vector<std::size_t>& from, double share) {
    if (options_.monitor.stopped()) return;
    TradePoint& point = out_.points[k];
    BodyPlanOptions search = plan_options(options_);
    const long budget = search.evaluations.value_or(search.default_evaluations(scenes_[k]));
    search.evaluations = std::max(1L, std::lround(share * double(budget)));
    if (point.found()) search.starts.push_back(point.motion);
    for (const std::size_t i : from) search.starts.push_back(out_.points[i].motion);
    const BodyPlan best = plan(scenes_[k], search);
    ++out_.plans;
    options_.monitor.progress(out_.plans, std::max(earlier_ + long(TradePoint::kPlans * (last_ - first_)), out_.plans));
    if (best.held_value > 0 && best.held_keeps_limits) point.held = best.held_value;
    if (best.found && best.value < point.planned) accept(k, best.motion, best.value, best.edges);
  }
  void accept(std::size_t k, const BodyMotion& motion, double value, const Edges& edges) {
    TradePoint& point = out_.points[k];
    point.motion = motion, point.planned = value, point.edges = edges;
    point.peak = peak_acceleration(scenes_[k], motion, {.accuracy = options_.search.accuracy}).peak;
  }

  /// Plays every neighbour's motion, and searches from those that are better than a design's own; false: none was.
  bool exchange() {
    bool improved = false;
    for (std::size_t k = first_; k < last_; ++k)
      for (const std::size_t i : neighbours(k)) {
        if (options_.monitor.stopped()) return false;
        const TradePoint& other = out_.points[i];
        const double v = value(k, other.motion);
        if (!(v < out_.points[k].planned * (1 - kMinGain))) continue;
        improved = true;
        accept(k, other.motion, v, other.edges);
        search(k, {i}, kReplanShare);
      }
    return improved;
  }

  /// The value of a motion for a design, as its plan is judged.
  double value(std::size_t k, const BodyMotion& motion) {
    if (goals_[k].drops.empty())
      goals_[k] = plan_goals(scenes_[k], options_.search, 1, judging_drops(options_.search)).judge;
    const Judged result = judged(goals_[k], motion, options_.search);
    return result.keeps_limits ? result.value : kNoMotion;
  }

  const TradeOptions& options_;
  Trade& out_;
  long earlier_ = 0;  ///< plans before those of the designs
  std::vector<BodyScene> scenes_;
  std::size_t first_ = 0, last_ = 0;  ///< the designs of this part, [first, last)
  std::vector<BodyGoal> goals_;       ///< by design, set when first used
};

void check(const std::vector<TradeAxis>& axes, const TradeOptions& options) {
  std::size_t count = 1;
  for (const TradeAxis& axis : axes) count *= axis.values.size();
  const TradePart& part = options.part;
  if (!(part.index < part.count && part.count <= count))
    throw InputError(
        fmt::format("part {} of {}: 1 to {} of as many at most are needed", part.index + 1, part.count, count));
  if (!options.known.empty() && options.known.size() != count)
    throw InputError(fmt::format("{} known designs: {} are needed", options.known.size(), count));
}

/// Index of the load of this name; "peak" is added where the scene has none.
std::size_t find_or_add_load(BodyScene& scene, const std::string& name, const std::string& option) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < scene.loads.size(); ++i) {
    if (scene.loads[i].name == name && scene.loads[i].kind != Load::Kind::kTouch) return i;
    if (scene.loads[i].kind != Load::Kind::kTouch) names.push_back(scene.loads[i].name);
  }
  constexpr const char* kPeak = "peak";
  if (std::find(names.begin(), names.end(), kPeak) == names.end()) names.push_back(kPeak);
  if (name != kPeak) throw InputError(option + ": " + one_of(name, names));
  scene.loads.push_back(
      {.name = kPeak, .kind = Load::Kind::kAcceleration, .index = scene.robot.peak_link, .at = scene.robot.peak});
  return scene.loads.size() - 1;
}

/// The scene with both loads of a front, neither of them a limit.
BodyScene with_both_loads(BodyScene scene, const std::string& cost, const std::string& limited,
                          const std::string& option = "pareto") {
  if (cost == limited) throw InputError(option + ": " + quoted(cost) + ": two loads are needed");
  scene.loads[find_or_add_load(scene, cost, option)].limit = false;
  scene.loads[find_or_add_load(scene, limited, option)].limit = false;
  return scene;
}

/// The scene whose plans minimise one load, in its unit, and keep the limits of the others.
BodyScene minimising(BodyScene scene, const std::string& name) {
  for (Load& l : scene.loads)
    if (l.name == name) l.limit = false, l.rating = 1;
  std::erase_if(scene.loads, [&](const Load& l) { return l.name != name && !l.limit; });
  return scene;
}

/// Measures a load as limits are checked: in the whole execution box, under scatter in the required share of drops; its
/// value is then the smallest limit that it keeps.
void measure_as_limit(BodyPlanOptions& search) {
  if (search.measure) {
    const double share = search.share.value_or(search.measure->share());
    search.measure = share < 1 ? Measure{Measure::Kind::kQuantile, share} : Measure{Measure::Kind::kWorst};
  } else if (search.goal != Goal::kTolerant) {
    constexpr long kBox = 8;  // mean number of landings of a box, as many are cut short
    search.goal = Goal::kTolerant;
    if (search.evaluations) search.evaluations = std::max(1L, *search.evaluations / kBox);
  }
}

/// A weighted minimax without the cliff of a limit: minimises the larger of cost / cost_scale and
/// limited / limited_scale. Its motions are near the front.
BodyScene weighted(BodyScene both, const std::string& cost, double cost_scale, const std::string& limited,
                   double limited_scale, const std::function<void(BodyScene&)>& prepare) {
  for (Load& l : both.loads) {
    if (l.name == cost) l.rating = cost_scale;
    if (l.name == limited) l.rating = limited_scale;
  }
  std::erase_if(both.loads, [&](const Load& l) { return l.name != cost && l.name != limited && !l.limit; });
  if (prepare) prepare(both);
  return both;
}

/// Starts of a front, one for each of its designs: at the ends those that minimise one load alone, weighted ones
/// between them. Known and reported as the designs are, at indices count + design.
class FrontStarts {
 public:
  FrontStarts(std::size_t count, const TradeOptions& options, long& plans)
      : count_(count), options_(options), plans_(plans) {
    if (!options.known.empty() && options.known.size() != 2 * count)
      throw InputError(fmt::format("{} known points: {} are needed", options.known.size(), 2 * count));
  }

  /// The start of a design: the known one, else planned.
  TradePoint start(std::size_t design, const std::function<BodyPlan()>& plan) {
    const std::size_t index = count_ + design;
    if (!options_.known.empty() && options_.known[index].plans > 0) return options_.known[index];
    const BodyPlan best = plan();
    const bool stopped = options_.monitor.stopped();
    TradePoint out{.held = best.held_value, .planned = best.value};
    if (best.found) out.motion = best.motion, out.edges = best.edges;
    if (!best.found && (design == 0 || design + 1 == count_) && !stopped) throw InputError("pareto: " + best.message);
    ++plans_;
    options_.monitor.progress(plans_, long((1 + TradePoint::kPlans) * count_));
    out.plans = stopped ? 0 : 1;
    if (!stopped && options_.done) options_.done(index, out);
    return out;
  }
  /// The start of one of the two end designs.
  TradePoint end(std::size_t design, const BodyScene& scene, const BodyPlanOptions& search) {
    return start(design, [&] { return plan(scene, search); });
  }

 private:
  std::size_t count_;
  const TradeOptions& options_;
  long& plans_;
};

}  // namespace

void check_front(const BodyScene& scene, const std::string& cost, const std::string& limited,
                 const std::string& option) {
  (void)with_both_loads(scene, cost, limited, option);
}

Front pareto(const BodyScene& scene, const std::string& cost, const std::string& limited, std::size_t count,
             const TradeOptions& options) {
  constexpr double kMargin = 1e-3;  // of a limit, so that more than one motion keeps it
  scene.validate(), options.search.validate();
  if (count < 2) throw InputError("pareto: two designs or more are needed");
  const BodyScene both = with_both_loads(scene, cost, limited);
  Front out{minimising(both, cost), {}};
  BodyScene other = minimising(both, limited);
  if (options.prepare) options.prepare(other), options.prepare(out.scene);
  FrontStarts starts(count, options, out.trade.plans);

  BodyPlanOptions search = plan_options(options);
  const TradePoint cost_end = starts.end(count - 1, out.scene, search);
  const BodyGoal cost_goal = plan_goals(out.scene, search, 1, judging_drops(search)).judge;
  const auto cost_of = [&, o = search](const BodyMotion& m) { return judged(cost_goal, m, o).value; };
  measure_as_limit(search);
  const TradePoint limited_end = starts.end(0, other, search);
  const bool stopped = options.monitor.stopped();
  const double low = limited_end.planned;
  const double highest_cost = stopped ? 0 : std::min(cost_of(limited_end.motion), cost_end.held);
  double high = low;  // if stopped before the ends are known
  if (!stopped) high = judged(plan_goals(other, search, 1, judging_drops(search)).judge, cost_end.motion, search).value;

  const Load limit =
      *std::find_if(both.loads.begin(), both.loads.end(), [&](const Load& l) { return l.name == limited; });
  out.scene.loads.push_back(limit), out.scene.loads.back().limit = true;
  TradeAxis axis{"load." + limited + ".rating", {low * (1 + kMargin)}};
  for (std::size_t i = 1; low < high && i < count; ++i)
    axis.values.push_back((low + (high - low) * double(i) / double(count - 1)) * (1 + kMargin));
  const std::size_t designs = axis.values.size();
  TradeOptions axis_options = options;
  if (!axis_options.known.empty()) axis_options.known.resize(designs);
  if (designs < count) axis_options.part = {};
  check({axis}, axis_options);
  TradePlanner planner(out.scene, {axis}, axis_options, out.trade);
  if (stopped) return out;
  planner.add_start(0, limited_end.motion, limited_end.edges);
  planner.add_start(designs - 1, cost_end.motion, cost_end.edges);
  for (std::size_t i = 1; low < high && highest_cost > 0 && i + 1 < designs; ++i) {
    const double cost_scale = highest_cost + double(i) / double(designs - 1) * (cost_end.planned - highest_cost);
    const TradePoint between = starts.start(
        i, [&] { return plan(weighted(both, cost, cost_scale, limited, axis.values[i], options.prepare), search); });
    for (std::size_t k = 0; k < designs; ++k) planner.add_start(k, between.motion, between.edges);
  }
  planner.run();
  for (std::size_t k = designs; options.done && k < count && !options.monitor.stopped(); ++k)
    options.done(k, out.trade.points[0]);  // a single design
  return out;
}

Trade trade(const BodyScene& scene, const std::vector<TradeAxis>& axes, const TradeOptions& options) {
  scene.validate(), options.search.validate();
  if (axes.empty() || axes.size() > 2) throw InputError(fmt::format("{} axes: one or two are needed", axes.size()));
  for (const TradeAxis& axis : axes) {
    const auto not_increasing = std::adjacent_find(axis.values.begin(), axis.values.end(), std::greater_equal<>());
    if (axis.values.size() < 2 || not_increasing != axis.values.end())
      throw InputError(axis.name + ": two values or more that rise are needed");
  }
  check(axes, options);
  Trade out;
  TradePlanner(scene, axes, options, out).run();
  return out;
}

}  // namespace ukemi::landing

#include "landing/plan/trade.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "landing/plan/body_goal.hpp"
#include "landing/plan/design_numbers.hpp"

namespace ukemi::landing {

namespace {

class Trader {
 public:
  Trader(const BodyScene& scene, const std::vector<TradeAxis>& axes, const TradeOptions& options, Trade& out)
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
    judges_.resize(count);
    for (const TradeAxis& axis : axes) out.middle = out.middle * axis.values.size() + axis.values.size() / 2;
  }

  void run() {
    const std::size_t n = out_.points.size(), middle = out_.middle;
    plan_at(middle, {}, 1);
    for (std::size_t k = middle + 1; k < n; ++k) plan_at(k, neighbours(k), 1);
    for (std::size_t k = middle; k-- > 0;) plan_at(k, neighbours(k), 1);
    for (std::size_t k = 0; k < n; ++k)
      if (k != middle) plan_at(k, neighbours(k), kAgain);
    while (exchange()) {
    }
    const TradePoint& m = out_.points[middle];
    for (std::size_t k = 0; m.found() && k < n; ++k)
      out_.points[k].unchanged = k == middle ? m.planned : value(k, m.motion);
  }

 private:
  static constexpr double kAgain = 0.25;  // of a plan's budget: from what the neighbours have found since
  static constexpr double kBetter = 1e-6;

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

  /// Searches from the motions of some designs and its own, and keeps what is better than what is known.
  void plan_at(std::size_t k, const std::vector<std::size_t>& from, double part) {
    if (options_.monitor.stopped()) return;
    TradePoint& point = out_.points[k];
    BodyPlanOptions search = options_.search;
    search.fresh = 0, search.rate = 0, search.deadline.reset(), search.starts.clear();
    search.monitor = {{}, options_.monitor.stop};
    const long budget = search.evaluations.value_or(search.default_evaluations(scenes_[k]));
    search.evaluations = std::max(1L, std::lround(part * double(budget)));
    if (point.found()) search.starts.push_back(point.motion);
    for (const std::size_t i : from) search.starts.push_back(out_.points[i].motion);
    const BodyPlan best = plan(scenes_[k], search);
    ++out_.plans;
    options_.monitor.progress(out_.plans, std::max(long(2 * out_.points.size() - 1), out_.plans));
    if (best.held_value > 0 && best.held_keeps_limits) point.held = best.held_value;
    if (best.found && best.value < point.planned) accept(k, best.motion, best.value, best.edges);
  }
  void accept(std::size_t k, const BodyMotion& motion, double value, const Edges& edges) {
    TradePoint& point = out_.points[k];
    point.motion = motion, point.planned = value, point.edges = edges;
    point.peak = peak_acceleration(scenes_[k], motion, {.accuracy = options_.search.accuracy}).peak;
  }

  /// Plays every neighbour's motion; searches from those that are better than a design's own. False: there was none.
  bool exchange() {
    bool better = false;
    for (std::size_t k = 0; k < out_.points.size(); ++k)
      for (const std::size_t i : neighbours(k)) {
        if (options_.monitor.stopped()) return false;
        const TradePoint& other = out_.points[i];
        const double v = value(k, other.motion);
        if (!(v < std::min(kNoMotion, out_.points[k].planned * (1 - kBetter)))) continue;
        better = true;
        accept(k, other.motion, v, other.edges);
        plan_at(k, {i}, kAgain);
      }
    return better;
  }

  /// What a motion is worth for a design, as its plan is judged.
  double value(std::size_t k, const BodyMotion& motion) {
    if (judges_[k].drops.empty())
      judges_[k] = plan_goals(scenes_[k], options_.search, 1, judging_drops(options_.search)).judge;
    const Judged result = judged(judges_[k], motion, options_.search);
    return result.keeps_limits ? result.value : kNoMotion;
  }

  const TradeOptions& options_;
  Trade& out_;
  std::vector<BodyScene> scenes_;
  std::vector<BodyGoal> judges_;  ///< of the designs that neighbours' motions were played on
};

}  // namespace

Trade trade(const BodyScene& scene, const std::vector<TradeAxis>& axes, const TradeOptions& options) {
  scene.validate(), options.search.validate();
  if (axes.empty() || axes.size() > 2) throw InputError(fmt::format("{} axes: one or two are needed", axes.size()));
  for (const TradeAxis& axis : axes) {
    const auto falls = std::adjacent_find(axis.values.begin(), axis.values.end(), std::greater_equal<>());
    if (axis.values.size() < 2 || falls != axis.values.end())
      throw InputError(axis.name + ": two values or more that rise are needed");
  }
  Trade out;
  Trader(scene, axes, options, out).run();
  return out;
}

}  // namespace ukemi::landing

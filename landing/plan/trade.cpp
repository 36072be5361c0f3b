#include "landing/plan/trade.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "landing/plan/body_goal.hpp"
#include "landing/plan/design_numbers.hpp"
#include "landing/scatter/sampler.hpp"

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
    for (const TradeAxis& axis : axes) out.middle = out.middle * axis.values.size() + axis.values.size() / 2;
  }

  void run() {
    const std::size_t n = out_.points.size(), middle = out_.middle;
    total_ = long(2 * n - 1);
    plan_at(middle, {}, 1);
    const BodyMotion unchanged = out_.points[middle].motion;
    for (std::size_t k = middle + 1; k < n; ++k) plan_at(k, neighbours(k, true), 1);
    for (std::size_t k = middle; k-- > 0;) plan_at(k, neighbours(k, true), 1);
    for (std::size_t k = 0; k < n; ++k)
      if (k != middle) plan_at(k, neighbours(k, true), kAgain);
    while (exchange()) {
    }
    for (std::size_t k = 0; k < n; ++k) {
      TradePoint& p = out_.points[k];
      p.unchanged = k == middle ? p.planned : value(k, unchanged);
    }
  }

 private:
  static constexpr double kAgain = 0.25;  // of a plan's budget: from what the neighbours have found since
  static constexpr double kBetter = 1e-6;

  bool over() const { return options_.search.monitor.stopped() || options_.monitor.stopped(); }

  /// Designs one step away along an axis; `planned`: those that have a motion.
  std::vector<std::size_t> neighbours(std::size_t k, bool planned) const {
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
    if (planned) std::erase_if(out, [&](std::size_t i) { return !out_.points[i].found; });
    return out;
  }

  /// Searches from the motions of some designs and its own, and keeps what is better than what is known.
  void plan_at(std::size_t k, const std::vector<std::size_t>& from, double part) {
    TradePoint& point = out_.points[k];
    if (over()) return;
    BodyPlanOptions search = options_.search;
    search.fresh = 0, search.rate = 0, search.deadline.reset(), search.starts.clear();
    const long budget = search.evaluations.value_or(search.default_evaluations(scenes_[k]));
    search.evaluations = std::max(1L, std::lround(part * double(budget)));
    if (point.found) search.starts.push_back(point.motion);
    for (const std::size_t i : from) search.starts.push_back(out_.points[i].motion);
    const BodyPlan best = plan(scenes_[k], search);
    ++out_.plans;
    options_.monitor.progress(out_.plans, std::max(total_, out_.plans));
    out_.variables = best.variables;
    point.held = best.held_value > 0 && best.held_keeps_limits ? best.held_value : kNoMotion;
    if (best.found && (!point.found || best.value < point.planned))
      point.found = true, point.planned = best.value, point.peak = best.landing.peak, point.motion = best.motion,
      point.edges = best.edges;
  }

  /// Plays every neighbour's motion; searches from those that are better than a design's own. False: there was none.
  bool exchange() {
    bool better = false;
    for (std::size_t k = 0; k < out_.points.size() && !over(); ++k) {
      TradePoint& point = out_.points[k];
      for (const std::size_t i : neighbours(k, true)) {
        const BodyMotion motion = out_.points[i].motion;
        const double v = value(k, motion);
        if (!(v < (point.found ? point.planned * (1 - kBetter) : kNoMotion))) continue;
        better = point.found = point.neighbours = true;
        point.planned = v, point.motion = motion;
        point.peak = peak_acceleration(scenes_[k], motion, {.accuracy = options_.search.accuracy}).peak;
        plan_at(k, {i}, kAgain);
      }
    }
    return better;
  }

  /// What a motion is worth for a design, as its plan is judged.
  double value(std::size_t k, const BodyMotion& motion) const {
    const BodyPlanOptions& o = options_.search;
    BodyGoal goal = own_drop(scenes_[k]);
    const bool tolerant = o.goal == Goal::kTolerant;
    if (o.measure) {
      const BodyDropModel model(scenes_[k], scatter_for(o.scatter, scenes_[k]),
                                {.inflate = o.inflate, .inexact = tolerant});
      if (model.scatters())
        goal = {.measure = *o.measure,
                .drops = model.even(o.judging, judging_seed(o.seed)),
                .share = o.share.value_or(o.measure->share())};
    } else if (tolerant || scenes_[k].limited()) {
      goal = execution_box(scenes_[k], tolerant);
    }
    for (BodyDrop& d : goal.drops) d.scene.limits.broken = BodyLimits::Broken::kTold;
    PeaksOver over = peaks_over(goal.drops, motion, o.measure ? kSearchAccuracy : o.accuracy, o.threads);
    const double v = goal.measure.of(std::span(over.peaks).first(goal.counted));
    return std::isfinite(v) && over.broken <= goal.may_break() ? v : kNoMotion;
  }

  const TradeOptions& options_;
  Trade& out_;
  std::vector<BodyScene> scenes_;
  long total_ = 0;
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

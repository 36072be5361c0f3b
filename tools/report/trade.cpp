#include "tools/report/trade.hpp"

#include <fmt/format.h>

#include "landing/body/load.hpp"
#include "tools/report/body.hpp"
#include "tools/report/landing.hpp"
#include "tools/report/scatter.hpp"

namespace ukemi::tools {

const Outputs kTradeOutputs{"trade", {"trade.csv", kTradeJournal}, {"trade"}};

using namespace landing;

namespace {

Json or_null(double value) { return value < kNoMotion ? Json(value) : Json(); }

/// Unit of a load.
std::string load_unit(const Load& l) { return unit(l.kind); }

/// The load that a front minimises.
const Load& cost_of(const BodyScene& scene) {
  return *std::find_if(scene.loads.begin(), scene.loads.end(), [](auto& l) { return !l.limit; });
}

/// A trade with the names, units and points that its report shows.
struct TradeView {
  explicit TradeView(const TradeResult& r) : result(r) {
    const bool front = r.of == TradeResult::Of::kFront;
    const std::string goal = goal_words(r.scene, r.search);
    unit = front ? load_unit(cost_of(r.scene)) : unit_of(r.scene);
    what = front ? cost_of(r.scene).name : goal;
    for (const TradeAxis& axis : r.trade.axes) axes.push_back(axis.name);
    if (front) axes[0] = fmt::format("{} at most [{}]", r.scene.loads.back().name, load_unit(r.scene.loads.back()));
    std::copy_if(r.trade.points.begin(), r.trade.points.end(), std::back_inserter(points),
                 [](auto& p) { return p.plans > 0 || p.found(); });
  }
  const TradeResult& result;
  std::string what, unit;          ///< of the minimised quantity
  std::vector<std::string> axes;   ///< names of the axes
  std::vector<TradePoint> points;  ///< the planned ones
};

Quantities<TradePoint> trade_quantities(const TradeView& t) {
  const BodyScene& scene = t.result.scene;
  const Trade& trade = t.result.trade;
  const std::string unit = fmt::format(" [{}]", t.unit);
  Quantities<TradePoint> out;
  for (std::size_t a = 0; a < trade.axes.size(); ++a)
    out.push_back({trade.axes[a].name, trade.axes[a].name, t.axes[a], "{:.4g}",
                   [a](const TradePoint& p) { return Json(p.at[a]); }});
  out.push_back({"held", "held", "held" + unit, "{:.4g}", [](auto& p) { return or_null(p.held); }});
  out.push_back(
      {"unchanged", "unchanged", "the middle's motion" + unit, "{:.4g}", [](auto& p) { return or_null(p.unchanged); }});
  out.push_back(
      {"planned", "planned", t.what + ", planned" + unit, "{:.4g}", [](auto& p) { return or_null(p.planned); }});
  out.push_back({"peak", "peak_acceleration", "its peak [m/s^2]", "{:.4g}", [](auto& p) { return or_null(p.peak); }});
  const auto found = std::find_if(t.points.begin(), t.points.end(), [](auto& p) { return p.found(); });
  if (found != t.points.end())
    append(out, "motion/", motion_quantities(scene.robot, found->motion), &TradePoint::motion, &TradePoint::found);
  return out;
}

void draw(const TradeView& t, Report& page) {
  const Trade& trade = t.result.trade;
  const std::string what = fmt::format("{} [{}]", t.what, t.unit);
  const auto curve = [&](const char* name, auto&& of) {
    Series s{.name = name};
    for (const TradePoint& p : trade.points)
      if (const double v = of(p); v < kNoMotion) s.x.push_back(p.at[0]), s.y.push_back(v);
    return s;
  };
  const auto planned = [](const TradePoint& p) { return p.planned; };
  if (trade.axes.size() == 1) {
    page.plot("trade", t.axes[0], what,
              {curve("planned for each", planned), curve("the middle's motion", [](auto& p) { return p.unchanged; }),
               curve("held", [](auto& p) { return p.held; })});
    return;
  }
  Heatmap map{t.axes[0], t.axes[1], trade.axes[0].values, trade.axes[1].values, {}};
  for (std::size_t y = 0; y < map.y.size(); ++y)
    for (std::size_t x = 0; x < map.x.size(); ++x) {
      const double v = planned(trade.points[x * map.y.size() + y]);
      map.values.push_back(v < kNoMotion ? v : std::numeric_limits<double>::quiet_NaN());
    }
  page.heading("Planned for each design: " + what);
  page.heatmap(map);
}

/// Values of a design: "drive.knee.k_sea 20".
std::string design_words(const TradeView& t, const TradePoint& p) {
  std::vector<std::string> parts;
  for (std::size_t a = 0; a < t.axes.size(); ++a) parts.push_back(fmt::format("{} {:.4g}", t.axes[a], p.at[a]));
  return fmt::format("{}", fmt::join(parts, ", "));
}

/// The best planned design; null: none has a motion.
const TradePoint* best_of(const TradeView& t) {
  const TradePoint* out = nullptr;
  for (const TradePoint& p : t.points)
    if (p.found() && (!out || p.planned < out->planned)) out = &p;
  return out;
}

/// "peak: 41.1 m/s^2 with knee at most 8.6 Nm, 172 m/s^2 with at most 1.3 Nm", or the lowest design.
std::string sentence(const TradeView& t) {
  const TradePoint* const best = best_of(t);
  if (t.points.empty()) return "Nothing is planned yet.";
  if (!best) return "No motion was found.";
  if (t.result.of == TradeResult::Of::kDesigns)
    return fmt::format("Lowest: {:.4g} {} at {}.", best->planned, t.unit, design_words(t, *best));
  const std::string limited = load_unit(t.result.scene.loads.back());
  const TradePoint* const first = &*std::find_if(t.points.begin(), t.points.end(), [](auto& p) { return p.found(); });
  if (first == best)
    return fmt::format("No conflict: {:.4g} {} with {}.", best->planned, t.unit, design_words(t, *best));
  return fmt::format("{}: {:.4g} {} with {} at most {:.4g} {}, {:.4g} {} with at most {:.4g} {}.", t.what,
                     best->planned, t.unit, t.result.scene.loads.back().name, best->at[0], limited, first->planned,
                     t.unit, first->at[0], limited);
}

FirstScreen first_screen(const TradeView& t, long missing, long edges) {
  const std::size_t n = t.result.trade.points.size();
  FirstScreen out{.sentence = sentence(t)};
  out.checks = {
      check(missing == 0, "planned", fmt::format("{} of {} designs have a motion", n - std::size_t(missing), n)),
      Check{edges == 0 ? Check::State::kGood : Check::State::kCaution, "within search ranges",
            fmt::format("{} of {} motions lie on an edge", edges, n)}};
  out.next = "Put the value that you choose into the robot's file, and plan with `ukemi optimize`.";
  return out;
}

}  // namespace

int report(const TradeResult& r, Run& run) {
  const TradeView t(r);
  const Trade& trade = r.trade;
  long edges = 0;
  for (const TradePoint& p : t.points)
    edges += std::any_of(p.edges.begin(), p.edges.end(), [](auto e) { return e != 0; });
  const long found = std::count_if(t.points.begin(), t.points.end(), [](auto&p) { return p.found(); }),
             missing = long(t.points.size()) - found;
  if (missing > 0)
    run.warn(fmt::format("{} of {} designs: no motion was found{}", missing, t.points.size(),
                         r.scene.limited() ? " that keeps the limits" : ""));
  if (edges > 0)
    run.warn(fmt::format("{} of {} motions lie on an edge of their search range: beyond it may be better", edges,
                         t.points.size()));
  const auto same = [&](const TradePoint& p) { return p.planned == t.points[0].planned && p.held == t.points[0].held; };
  if (found > 1 && r.of == TradeResult::Of::kDesigns && std::all_of(t.points.begin(), t.points.end(), same))
    run.warn("every design lands alike: what was varied has no effect here");
  Report page((r.of == TradeResult::Of::kFront ? "What one load costs in another: " : "What a design buys: ") +
              r.scene.name);
  page.answer(first_screen(t, long(trade.points.size()) - found, edges), run.warnings());
  draw(t, page);
  page.paragraph(
      "For each value the best motion that was found for it, beside the held posture and the motion that is best for "
      "the middle value, unchanged.");
  const Table table(trade_quantities(t), t.points);
  Json summary = {{"goal", t.what}, {"unit", t.unit}, {"plans", trade.plans}};
  summary["points"] = add_table(table, page, run, "trade.csv", "Values as in the files; m/s^2, deg, s.");
  run.say(sentence(t));
  if (const TradePoint* const best = best_of(t)) summary["best"] = {{"planned", best->planned}, {"at", best->at}};
  summary["middle"] = trade.points[trade.middle].at;
  if (!r.shard.empty()) summary["shard"] = r.shard;
  if (!r.journal.empty()) run.add(kTradeJournal, r.journal);
  page.distrust(run.warnings());
  page.write(run);
  return run.finish(summary, found == 0 ? kNumbers : kDone);
}

}  // namespace ukemi::tools

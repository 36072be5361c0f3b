#include "tools/report/trade.hpp"

#include <fmt/format.h>

#include <cmath>

#include "landing/body/load.hpp"
#include "tools/report/body.hpp"
#include "tools/report/landing.hpp"
#include "tools/report/scatter.hpp"

namespace ukemi::tools {

const Outputs kTradeOutputs{"trade", {"trade.csv"}, {"trade"}};

using namespace landing;

namespace {

Json worth(double value) { return value < kNoMotion ? Json(value) : Json(); }

Quantities<TradePoint> trade_quantities(const BodyScene& scene, const Trade& trade, const std::string& goal) {
  const std::string unit = fmt::format(" [{}]", worth_unit(rated(scene)));
  Quantities<TradePoint> out;
  for (std::size_t a = 0; a < trade.axes.size(); ++a)
    out.push_back({trade.axes[a].name, trade.axes[a].name, trade.axes[a].name, "{:.4g}",
                   [a](const TradePoint& p) { return Json(p.at[a]); }});
  out.push_back({"held", "held", "held" + unit, "{:.4g}", [](auto& p) { return worth(p.held); }});
  out.push_back(
      {"unchanged", "unchanged", "the middle's motion" + unit, "{:.4g}", [](auto& p) { return worth(p.unchanged); }});
  out.push_back({"planned", "planned", goal + ", planned" + unit, "{:.4g}", [](auto& p) { return worth(p.planned); }});
  out.push_back({"peak", "peak_acceleration", "its peak [m/s^2]", "{:.4g}", [](auto& p) { return worth(p.peak); }});
  const auto found = std::find_if(trade.points.begin(), trade.points.end(), [](auto& p) { return p.found(); });
  if (found != trade.points.end())
    append(out, "motion/", motion_quantities(scene.robot, found->motion), &TradePoint::motion, &TradePoint::found);
  return out;
}

void draw(const Trade& trade, const std::string& goal, Report& page) {
  const auto curve = [&](const char* name, auto&& of) {
    Series s{.name = name};
    for (const TradePoint& p : trade.points)
      if (const double v = of(p); v < kNoMotion) s.x.push_back(p.at[0]), s.y.push_back(v);
    return s;
  };
  const auto planned = [](const TradePoint& p) { return p.planned; };
  if (trade.axes.size() == 1) {
    page.plot("trade", trade.axes[0].name, goal,
              {curve("planned for each", planned), curve("the middle's motion", [](auto& p) { return p.unchanged; }),
               curve("held", [](auto& p) { return p.held; })});
    return;
  }
  Heatmap map{trade.axes[0].name, trade.axes[1].name, trade.axes[0].values, trade.axes[1].values, {}};
  for (std::size_t y = 0; y < map.y.size(); ++y)
    for (std::size_t x = 0; x < map.x.size(); ++x) {
      const double v = planned(trade.points[x * map.y.size() + y]);
      map.values.push_back(v < kNoMotion ? v : std::numeric_limits<double>::quiet_NaN());
    }
  page.heading("Planned for each design: " + goal);
  page.heatmap(map);
}

/// Designs, with their values: "drive.knee.k_sea 20".
std::string design_words(const Trade& trade, const TradePoint& p) {
  std::vector<std::string> parts;
  for (std::size_t a = 0; a < trade.axes.size(); ++a)
    parts.push_back(fmt::format("{} {:.4g}", trade.axes[a].name, p.at[a]));
  return fmt::format("{}", fmt::join(parts, ", "));
}

}  // namespace

int report(const BodyScene& scene, const Trade& trade, const BodyPlanOptions& search, Run& run) {
  const std::string goal = goal_words(scene, search);
  const TradePoint* best = nullptr;
  long missing = 0, edges = 0;
  for (const TradePoint& p : trade.points) {
    missing += !p.found();
    edges += std::any_of(p.edges.begin(), p.edges.end(), [](auto e) { return e != 0; });
    if (p.found() && (!best || p.planned < best->planned)) best = &p;
  }
  if (missing > 0)
    run.warn(fmt::format("{} of {} designs: no motion was found{}", missing, trade.points.size(),
                         scene.limits.any() ? " that keeps the limits" : ""));
  if (edges > 0)
    run.warn(fmt::format("{} of {} motions lie on an edge of their search range: beyond it may be better", edges,
                         trade.points.size()));
  Report page("What a design buys: " + scene.name);
  page.paragraph(
      "For each value the best motion that was found for it, beside the held posture and the motion that is best for "
      "the "
      "middle value, unchanged.");
  const Table table(trade_quantities(scene, trade, goal), trade.points);
  Json summary = {{"goal", goal}, {"plans", trade.plans}};
  summary["points"] = add_table(table, page, run, "trade.csv", "Values as in the files; m/s^2, deg, s.");
  if (best) {
    run.say(fmt::format("lowest: {} at {}", worth_words(best->planned, rated(scene)), design_words(trade, *best)));
    summary["best"] = {{"planned", best->planned}, {"at", best->at}};
  }
  summary["middle"] = trade.points[trade.middle].at;
  draw(trade, fmt::format("{} [{}]", goal, worth_unit(rated(scene))), page);
  page.distrust(run.warnings());
  page.write(run);
  return run.finish(summary, missing == long(trade.points.size()) ? kNumbers : kDone);
}

}  // namespace ukemi::tools

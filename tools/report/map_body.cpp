#include <fmt/format.h>

#include "landing/body/load.hpp"
#include "tools/report/body.hpp"
#include "tools/report/map.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

Quantities<BodyBasin> basin_quantities(const Robot& robot, const BodyMotion& like, bool rated) {
  Quantities<BodyBasin> out;
  append(out, "motion/", motion_quantities(robot, like), &BodyBasin::motion);
  const auto add = [&](const char* csv, const char* json, const char* words, auto show, auto of) {
    out.push_back({csv, json, fmt::format("{} [{}]", words, goal_unit(rated)), show, of});
  };
  const auto tolerant = [](const BodyBasin& b) { return number(b.tolerant); };
  if (rated) {
    add("largest_load", "largest_load", "largest load", "{:.4g}", &BodyBasin::peak);
    add("tolerant_load", "tolerant_load", "tolerant", short_peak_words, tolerant);
  } else {
    add("peak", "peak_acceleration", "peak", "{:.2f}", &BodyBasin::peak);
    add("tolerant_peak", "tolerant_peak", "tolerant peak", peak_words, tolerant);
  }
  return out;
}

Json minima_json(const BodySurvey& s) {
  Json out = Json::array();
  for (const GridMinimum& m : s.minima)
    out.push_back({{"motion", Table::of(motion_quantities(s.scene.robot, m.motion), m.motion).object()},
                   {rated(s.scene) ? "largest_load" : "peak_acceleration", m.peak}});
  return out;
}

}  // namespace

int report(const BodySurvey& s, Run& run) {
  const Robot& robot = s.scene.robot;
  const bool of_loads = rated(s.scene);
  const BodyMotion like = s.basins.empty() ? BodyMotion(robot.joints.size()) : s.basins[0].motion;
  MapTexts texts{.scene = s.scene.name,
                 .source = s.scene.source,
                 .points = {},
                 .points_words = "names",
                 .basins = Table(basin_quantities(robot, like, of_loads), s.basins),
                 .basins_comment =
                     "tolerant_peak: the worst within the execution tolerance; empty: one of its drops could not be "
                     "followed, or breaks a limit.",
                 .basins_words =
                     "Searched from the grid's local minima over all variables, those that stand on the grid included; "
                     "and the worst peak within the execution tolerance. The minima of the grid itself: summary.json.",
                 .rated = of_loads};
  for (const ContactPoint& c : robot.contacts) texts.points.push_back(c.name);
  for (const BodyBasin& b : s.basins)
    texts.lines.push_back(fmt::format("{}; {} {}; tolerant {}", motion_words(robot, b.motion), goal_name(of_loads),
                                      goal_text(b.peak, of_loads), goal_text(b.tolerant, of_loads)));
  if (!s.basins.empty())
    texts.best =
        fmt::format("{} at {}", goal_text(s.basins[0].peak, of_loads), motion_words(robot, s.basins[0].motion));
  if (!s.minima.empty())
    run.say(fmt::format("lowest of the grid: {}, {}", goal_text(s.minima[0].peak, of_loads),
                        motion_words(robot, s.minima[0].motion)));
  return report(s, texts, run, {{"minima", minima_json(s)}});
}

}  // namespace ukemi::tools

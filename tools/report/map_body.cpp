#include <fmt/format.h>

#include "tools/report/body.hpp"
#include "tools/report/map.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

Quantities<BodyBasin> basin_quantities(const Robot& robot, const BodyMotion& like) {
  Quantities<BodyBasin> out;
  append(out, "motion/", motion_quantities(robot, like), &BodyBasin::motion);
  out.push_back({"peak", "peak_acceleration", "peak [m/s^2]", "{:.2f}", &BodyBasin::peak});
  out.push_back({"tolerant_peak", "tolerant_peak", "tolerant peak [m/s^2]", peak_words,
                 [](const BodyBasin& b) { return number(b.tolerant); }});
  return out;
}

Json minima_json(const BodySurvey& s) {
  Json out = Json::array();
  for (const GridMinimum& m : s.minima)
    out.push_back({{"motion", Table::of(motion_quantities(s.scene.robot, m.motion), m.motion).object()},
                   {"peak_acceleration", m.peak}});
  return out;
}

}  // namespace

int report(const BodySurvey& s, Run& run) {
  const Robot& robot = s.scene.robot;
  const BodyMotion like = s.basins.empty() ? BodyMotion(robot.joints.size()) : s.basins[0].motion;
  MapTexts texts{.scene = s.scene.name,
                 .source = s.scene.source,
                 .contacts = MapTexts::Contacts::kUnknown,
                 .basins = Table(basin_quantities(robot, like), s.basins),
                 .basins_comment =
                     "tolerant_peak: the worst within the execution tolerance; empty: one of its drops could not be "
                     "followed.",
                 .basins_words =
                     "Searched from the grid's local minima over all variables, those that stand on the grid included; "
                     "and the worst peak within the execution tolerance. The minima of the grid itself: summary.json."};
  for (const BodyBasin& b : s.basins)
    texts.lines.push_back(fmt::format("{}; peak {:.2f}; tolerant peak {} m/s^2", motion_words(robot, b.motion), b.peak,
                                      short_peak_words(b.tolerant)));
  if (!s.basins.empty())
    texts.best = fmt::format("{:.4f} m/s^2 at {}", s.basins[0].peak, motion_words(robot, s.basins[0].motion));
  if (!s.minima.empty())
    run.say(
        fmt::format("lowest of the grid: {:.2f} m/s^2, {}", s.minima[0].peak, motion_words(robot, s.minima[0].motion)));
  return report(s, texts, run, {{"minima", minima_json(s)}});
}

}  // namespace ukemi::tools

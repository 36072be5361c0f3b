#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "landing/body/load.hpp"
#include "landing/judge/survey.hpp"
#include "tools/report/body.hpp"
#include "tools/report/landing.hpp"
#include "tools/report/results.hpp"

namespace ukemi::tools {

const Outputs kMapOutputs{"map", {"map.csv", "basins.csv", "set_scene.toml", "set_robot.toml"}, {"map"}};

using namespace landing;

namespace {

/// What the report of a map needs besides its grid.
struct MapTexts {
  std::vector<std::string> points;  ///< the contacts, as map.csv names them
  std::string points_words;         ///< what the names mean
  Table basins;
  std::string basins_comment, basins_words;  ///< in basins.csv and on the page
  std::vector<std::string> lines;            ///< one per basin, the best first
  std::string best;                          ///< the best basin
  bool rated = false;                        ///< peaks are loads divided by their ratings
};

/// Names of the contacts in the order of touchdown; longer ones than a letter are separated by spaces.
std::string contact_names(const ContactOrder& contacts, const std::vector<std::string>& points) {
  const bool letters = std::all_of(points.begin(), points.end(), [](auto& p) { return p.size() == 1; });
  std::string s;
  for (int i = 0; i < contacts.size(); ++i) s += (i > 0 && !letters ? " " : "") + points[std::size_t(contacts[i])];
  return s;
}

std::string map_csv(const Run& run, const PeakMap& map, const MapTexts& texts) {
  CsvWriter csv = run.csv();
  csv.comment("contacts: " + texts.points_words +
              ", in the order in which they touch; peak_contact: which of them made the peak, counted from 1, 0: none. "
              "Without chatter; of a landing "
              "that breaks a limit up to there.");
  std::vector<Display> axes;
  std::vector<std::string> header;
  for (const Variable& v : map.variables) axes.push_back(display(v)), header.push_back(axes.back().key);
  header.insert(header.end(), {texts.rated ? "largest_load" : "peak", "peak_contact", "contacts"});
  csv.header(header);
  for (std::size_t i = 0; i < map.grid.size(); ++i) {
    const PeakMap::Cell& c = map.grid[i];
    if (c.end == End::kStopped) continue;
    const Coordinates x = map.values(map.place(i));
    for (int k = 0; k < int(x.size()); ++k) csv.cell(x[k] * axes[std::size_t(k)].factor);
    csv.cell(c.peak).cell(c.peak_contact + 1).cell(contact_names(c.contacts, texts.points));
    csv.end_row();
  }
  return csv.text();
}

Quantities<JudgedBasin> basin_quantities(const std::vector<Variable>& variables, const Motion& like) {
  Quantities<JudgedBasin> out;
  append(out, "motion/", motion_quantities(like), [](auto& b) { return b.basin.play.motion; });
  out.push_back({"peak", "peak_acceleration", "peak [m/s^2]", "{:.2f}", [](auto& b) { return b.basin.peak; }});
  append(out, "", evidence_quantities(variables, "tolerant peak [m/s^2]"), &JudgedBasin::evidence);
  return out;
}
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
    out.push_back({{"motion", motion_json(s.scene.robot, m.motion)},
                   {rated(s.scene) ? "largest_load" : "peak_acceleration", m.peak}});
  return out;
}

}  // namespace

Heatmap projection(const PeakMap& map, int x, int y) {
  const auto axis = [&](int k, std::vector<double>& at) {
    const Display variable = display(map.variables[std::size_t(k)]);
    for (int i = 0; i < map.cells[std::size_t(k)]; ++i) at.push_back(map.coordinate(k, i) * variable.factor);
    return variable.words;
  };
  Heatmap h;
  h.x_label = axis(x, h.x), h.y_label = axis(y, h.y);
  h.values.assign(h.x.size() * h.y.size(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < map.grid.size(); ++i) {
    const PeakMap::Place at = map.place(i);
    double& best = h.values[std::size_t(at[std::size_t(y)]) * h.x.size() + std::size_t(at[std::size_t(x)])];
    best = std::fmin(best, map.grid[i].peak);
  }
  return h;
}

namespace {

/// Heat maps of all pairs of varied variables; of a single one a curve.
void show(const PeakMap& map, bool rated, Report& report) {
  std::vector<int> axes;
  for (int k = 0; k < int(map.cells.size()); ++k)
    if (map.cells[std::size_t(k)] > 1) axes.push_back(k);
  if (axes.size() == 1) {
    const Heatmap line = projection(map, axes[0], axes[0]);
    Series peaks{"", line.x, {}};
    for (std::size_t i = 0; i < line.x.size(); ++i) peaks.y.push_back(map.grid[i].peak);
    report.plot("map", line.x_label, fmt::format("{} [{}]", goal_name(rated), goal_unit(rated)), {peaks});
    return;
  }
  report.heading(fmt::format("Smallest {} over the other variables [{}]", goal_name(rated), goal_unit(rated)));
  for (std::size_t x = 0; x < axes.size(); ++x)
    for (std::size_t y = x + 1; y < axes.size(); ++y) report.heatmap(projection(map, axes[x], axes[y]));
}

void warn(const MappedPeaks& s, bool basins, Run& run) {
  const std::size_t points = s.map.grid.size();
  if (s.failed > 0) run.warn(fmt::format("{} of {} landings could not be followed", s.failed, points));
  if (s.lost > 0)
    run.warn(fmt::format("in {} of {} landings the drive loses the joint: their peaks are those of a link that whirls",
                         s.lost, points));
  if (s.broken > 0) run.warn(fmt::format("{} of {} landings break a limit: they are left out", s.broken, points));
  if (s.missing > 0) run.warn(fmt::format("{} of {} landings were not played any more", s.missing, points));
  if (!basins && s.missing == 0)
    run.warn(fmt::format("no landing of the grid {}: no basin was found",
                         s.broken == 0                    ? "could be followed to the floor"
                         : std::size_t(s.broken) < points ? "that could be followed to the floor keeps every limit"
                                                          : "keeps every limit"));
}

/// Reports and writes a map. Returns the exit code. `extra`: further keys of the summary.
template <class Mapped>
int report_map(const Mapped& s, const MapTexts& texts, Run& run, const Json& extra = Json::object()) {
  const std::size_t points = s.map.grid.size();
  warn(s, !texts.lines.empty(), run);
  run.add("map.csv", map_csv(run, s.map, texts));
  Json summary = {{"grid", s.map.cells},
                  {"landings", points - std::size_t(s.missing)},
                  {"failed", s.failed},
                  {"broken", s.broken},
                  {"joint_lost", s.lost},
                  {"map_time_s", s.map_seconds},
                  {"basins", texts.basins.objects()}};
  summary.update(extra);
  if (texts.lines.empty()) return run.finish(summary, kNumbers);
  run.add("basins.csv", texts.basins.csv(run, texts.basins_comment));
  run.say(fmt::format("{} landings in {:.2f} s; {} basins", points, s.map_seconds, texts.lines.size()));
  for (const std::string& line : texts.lines) run.say("  " + line);

  Report report("The box of motions: " + s.scene.name);
  floor_source(report, source_of(s.scene));
  report.paragraph(fmt::format("{} landings; {} basins. The best found: {}.", points, texts.lines.size(), texts.best));
  show(s.map, texts.rated, report);
  report.heading("Basins");
  report.paragraph(texts.basins_words);
  report.table(texts.basins);
  report.answer({fmt::format("The best of {} landings: {}. {} basins.", points, texts.best, texts.lines.size()),
                 {check(s.missing == 0, "every landing was played",
                        fmt::format("{} of {}", points - std::size_t(s.missing), points)),
                  check(s.lost == 0, "the drive keeps the joint", fmt::format("lost in {} landings", s.lost))},
                 "`ukemi optimize` searches between the points of the grid."},
                run.warnings());
  report.distrust(run.warnings());
  report.write(run);
  return run.finish(summary, kDone);
}

}  // namespace

int report(const Survey& s, Run& run) {
  MapTexts texts{
      .points = {"H", "K", "F"},
      .points_words = "H hip, K knee, F foot",
      .basins = Table(basin_quantities(s.map.variables, s.basins.empty() ? Motion{} : s.basins[0].basin.play.motion),
                      s.basins),
      .basins_comment =
          "width: how far a variable may move down and up before the peak rises by 5 %; then the worst peaks "
          "within the execution tolerance, with the angles off by 1 deg, the duration by 10 ms, the height "
          "by 1 cm, the pitch by 1 deg, the floor's damping by 10 %; empty: not played.",
      .basins_words =
          "How far each variable may move down and up before the peak rises by 5 %, and the worst peaks under "
          "deviations."};
  for (const JudgedBasin& b : s.basins)
    texts.lines.push_back(fmt::format("{}; peak {:.2f}; tolerant peak {:.1f} m/s^2", motion_words(b.basin.play.motion),
                                      b.basin.peak, b.evidence.tolerant.value));
  if (!s.basins.empty())
    texts.best = fmt::format("{:.4f} m/s^2 at {}", s.basins[0].basin.peak, motion_words(s.basins[0].basin.play.motion));
  return report_map(s, texts, run);
}

int report(const BodySurvey& s, Run& run) {
  const Robot& robot = s.scene.robot;
  const bool of_loads = rated(s.scene);
  const BodyMotion like = s.basins.empty() ? BodyMotion(robot.joints.size()) : s.basins[0].motion;
  MapTexts texts{.points = {},
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
  return report_map(s, texts, run, {{"minima", minima_json(s)}});
}

}  // namespace ukemi::tools

#include <fmt/format.h>

#include <cmath>

#include "landing/judge/survey.hpp"
#include "tools/report/landing.hpp"
#include "tools/report/results.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

std::string letters(const ContactOrder& contacts) {
  std::string s;
  for (int i = 0; i < contacts.size(); ++i) s += "HKF"[contacts[i]];
  return s;
}

std::string map_csv(const Run& run, const PeakMap& map) {
  CsvWriter csv = run.csv();
  csv.comment(
      "contacts: H hip, K knee, F foot, in the order in which they touch; peak_contact: which of them made the "
      "peak, counted from 1, 0: none.");
  std::vector<Display> axes;
  std::vector<std::string> header;
  for (const Variable& v : map.variables) axes.push_back(display(v)), header.push_back(axes.back().key);
  header.insert(header.end(), {"peak", "peak_contact", "contacts"});
  csv.header(header);
  for (std::size_t i = 0; i < map.grid.size(); ++i) {
    const PeakMap::Cell& c = map.grid[i];
    if (c.end == End::kStopped) continue;
    const Coordinates x = map.values(map.place(i));
    for (int k = 0; k < int(x.size()); ++k) csv.cell(x[k] * axes[std::size_t(k)].factor);
    csv.cell(c.peak).cell(c.peak_contact + 1).cell(letters(c.contacts)).end_row();
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

int report(const Survey& s, Run& run) {
  const std::size_t points = s.map.grid.size();
  if (s.failed > 0) run.warn(fmt::format("{} of {} landings could not be followed", s.failed, points));
  if (s.lost > 0)
    run.warn(fmt::format("in {} of {} landings the drive loses the joint: their peaks are those of a link that whirls",
                         s.lost, points));
  if (s.missing > 0) run.warn(fmt::format("{} of {} landings were not played any more", s.missing, points));
  if (s.basins.empty() && s.missing == 0)
    run.warn("no landing of the grid could be followed to the floor: no basin was found");
  const Table basins(basin_quantities(s.map.variables, s.basins.empty() ? Motion{} : s.basins[0].basin.play.motion),
                     s.basins);
  run.add("map.csv", map_csv(run, s.map));
  const Json summary = {{"grid", s.map.cells},         {"landings", points - std::size_t(s.missing)},
                        {"failed", s.failed},          {"joint_lost", s.lost},
                        {"map_time_s", s.map_seconds}, {"basins", basins.objects()}};
  if (s.basins.empty()) return run.finish(summary, kNumbers);
  run.add(
      "basins.csv",
      basins.csv(run,
                 "width: how far a variable may move down and up before the peak rises by 5 %; then the worst peaks "
                 "within the execution tolerance, with the angles off by 1 deg, the duration by 10 ms, the height "
                 "by 1 cm, the pitch by 1 deg, the floor's damping by 10 %; empty: not played."));
  run.say(fmt::format("{} landings in {:.2f} s; {} basins", points, s.map_seconds, s.basins.size()));
  for (const JudgedBasin& b : s.basins)
    run.say(fmt::format("  {}; peak {:.2f}; tolerant peak {:.1f} m/s^2", motion_words(b.basin.play.motion),
                        b.basin.peak, b.evidence.tolerant.value));

  Report report("The box of motions: " + s.scene.name);
  floor_source(report, s.scene);
  report.paragraph(fmt::format("{} landings; {} basins. The best found: {:.4f} m/s² at {}.", points, s.basins.size(),
                               s.basins.front().basin.peak, motion_words(s.basins.front().basin.play.motion)));
  report.heading("Smallest peak over the other variables [m/s²]");
  for (int x = 0; x < int(s.map.cells.size()); ++x)
    for (int y = x + 1; y < int(s.map.cells.size()); ++y)
      if (s.map.cells[std::size_t(x)] > 1 && s.map.cells[std::size_t(y)] > 1) report.heatmap(projection(s.map, x, y));
  report.heading("Basins");
  report.paragraph(
      "How far each variable may move down and up before the peak rises by 5 %, and the worst peaks under deviations.");
  report.table(basins);
  report.distrust(run.warnings());
  report.write(run);
  return run.finish(summary, kDone);
}

}  // namespace ukemi::tools

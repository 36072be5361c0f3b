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
  csv.header({"phi_i_deg", "phi_f_deg", "duration", "peak", "peak_contact", "contacts"});
  for (int i = 0; i < map.cells[0]; ++i)
    for (int j = 0; j < map.cells[1]; ++j)
      for (int k = 0; k < map.cells[2]; ++k) {
        const PeakMap::Cell& c = map.grid[map.index(i, j, k)];
        const Motion m = map.motion(i, j, k);
        if (c.end == End::kStopped) continue;
        csv.cell(m.phi_i * kDegrees).cell(m.phi_f * kDegrees).cell(m.duration);
        csv.cell(c.peak).cell(c.peak_contact + 1).cell(letters(c.contacts)).end_row();
      }
  return csv.text();
}

/// The smallest peak over the axis that is not drawn.
Heatmap projection(const PeakMap& map, int x, int y, int over) {
  static constexpr std::array<const char*, 3> kLabels = {"phi_I [deg]", "phi_F [deg]", "duration [s]"};
  const auto unit = [](int axis) { return axis == 2 ? 1 : kDegrees; };
  Heatmap h{kLabels[std::size_t(x)], kLabels[std::size_t(y)], {}, {}, {}};
  for (int i = 0; i < map.cells[std::size_t(x)]; ++i) h.x.push_back(map.coordinate(x, i) * unit(x));
  for (int j = 0; j < map.cells[std::size_t(y)]; ++j) h.y.push_back(map.coordinate(y, j) * unit(y));
  for (int j = 0; j < map.cells[std::size_t(y)]; ++j)
    for (int i = 0; i < map.cells[std::size_t(x)]; ++i) {
      double best = std::numeric_limits<double>::infinity();
      for (int k = 0; k < map.cells[std::size_t(over)]; ++k) {
        std::array<int, 3> at{};
        at[std::size_t(x)] = i, at[std::size_t(y)] = j, at[std::size_t(over)] = k;
        best = std::fmin(best, map.grid[map.index(at[0], at[1], at[2])].peak);
      }
      h.values.push_back(best);
    }
  return h;
}

Quantities<JudgedBasin> basin_quantities() {
  Quantities<JudgedBasin> out;
  append(out, "motion/", motion_quantities(), [](auto& b) { return b.basin.motion; });
  out.push_back({"peak", "peak_acceleration", "peak [m/s^2]", "{:.2f}", [](auto& b) { return b.basin.peak; }});
  append(out, "", evidence_quantities("tolerant peak [m/s^2]"), &JudgedBasin::evidence);
  return out;
}

}  // namespace

int report(const Survey& s, Run& run) {
  const std::size_t points = s.map.grid.size();
  if (s.failed > 0) run.warn(fmt::format("{} of {} landings could not be followed", s.failed, points));
  if (s.missing > 0) run.warn(fmt::format("{} of {} landings were not played any more", s.missing, points));
  if (s.basins.empty() && s.missing == 0)
    run.warn("no landing of the grid could be followed to the floor: no basin was found");
  const Table basins(basin_quantities(), s.basins);
  run.add("map.csv", map_csv(run, s.map));
  const Json summary = {{"grid", s.map.cells},
                        {"landings", points - std::size_t(s.missing)},
                        {"failed", s.failed},
                        {"map_time_s", s.map_seconds},
                        {"basins", basins.objects()}};
  if (s.basins.empty()) return run.finish(summary, kNumbers);
  run.add(
      "basins.csv",
      basins.csv(run,
                 "width: how far a variable may move down and up before the peak rises by 5 %; then the worst peaks "
                 "within the execution tolerance, with the angles off by 1 deg, the duration by 10 ms, the height "
                 "by 1 cm, the pitch by 1 deg, the floor's damping by 10 %; empty: not played."));
  const std::string said = fmt::format("{} landings in {:.2f} s; {} basins", points, s.map_seconds, s.basins.size());
  run.say(said);
  for (const JudgedBasin& b : s.basins)
    run.say(fmt::format("  {}; peak {:.2f}; tolerant peak {:.1f} m/s^2", motion_words(b.basin.motion), b.basin.peak,
                        b.evidence.tolerant.value));

  Report report("The box of motions: " + s.scene.name);
  floor_source(report, s.scene);
  report.paragraph(said + fmt::format(". The best found: {:.4f} m/s² at {}.", s.basins.front().basin.peak,
                                      motion_words(s.basins.front().basin.motion)));
  report.heading("Smallest peak over the third variable [m/s²]");
  report.heatmap(projection(s.map, 0, 1, 2));
  report.heatmap(projection(s.map, 0, 2, 1));
  report.heatmap(projection(s.map, 1, 2, 0));
  report.heading("Basins");
  report.paragraph(
      "How far each variable may move down and up before the peak rises by 5 %, and the worst peaks under deviations.");
  report.table(basins);
  report.list(run.warnings());
  run.add("report.html", report.html(run.provenance()));
  return run.finish(summary, kDone);
}

}  // namespace ukemi::tools

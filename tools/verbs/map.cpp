// ukemi map.
#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "common/error.hpp"
#include "landing/judge/map.hpp"
#include "landing/model/scene_file.hpp"
#include "tools/program/actuators.hpp"
#include "tools/program/interrupt.hpp"
#include "tools/report/report.hpp"
#include "tools/verbs/verbs.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

struct MapArguments {
  std::string scene, actuator;
  std::vector<int> grid{64, 64, 32};
  int polish = MapOptions().polished;
};

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

int run_map(const MapArguments& a, const CommonOptions& common) {
  Run run("map", common);
  const Scene scene = read_scene(a.scene);
  run.input(a.scene);
  const Actuator actuator = actuator_of(a.actuator, run);
  if (a.grid.size() != 3) throw InputError("--grid: three numbers are needed, as in 64,64,32");
  MapOptions options;
  options.cells = {a.grid[0], a.grid[1], a.grid[2]};
  options.polished = a.polish, options.seed = common.seed, options.threads = common.threads;
  const double start = run.seconds();
  options.monitor = run.monitor("map: rows");
  const PeakMap map = map_peaks(scene, actuator.sea, options);
  const double map_seconds = run.seconds() - start;
  long failed = 0, missing = 0;
  for (const PeakMap::Cell& c : map.grid) failed += no_landing(c.end), missing += c.end == End::kStopped;
  if (failed > 0) run.warn(fmt::format("{} of {} landings could not be followed", failed, map.grid.size()));
  if (missing > 0) run.warn(fmt::format("{} of {} landings were not played any more", missing, map.grid.size()));
  options.monitor = run.monitor("map: basins");
  const std::vector<Basin> found = basins(scene, actuator.sea, map, options);
  Json summary;
  summary["grid"] = a.grid;
  summary["landings"] = map.grid.size() - std::size_t(missing), summary["failed"] = failed;
  summary["map_time_s"] = map_seconds;
  run.add("map.csv", map_csv(run, map));
  if (found.empty()) {
    if (missing == 0) run.warn("no landing of the grid could be followed to the floor: no basin was found");
    summary["basins"] = Json::array();
    return run.finish(summary, kNumbers);
  }

  CsvWriter csv = run.csv();
  csv.comment(
      "width: how far a variable may move down and up before the peak rises by 5 %; then the worst peaks "
      "within the execution tolerance, with the angles off by 1 deg, the duration by 10 ms, the height by 1 cm, the "
      "pitch by 1 deg, the floor's damping by 10 %; empty: not played.");
  csv.header({"phi_i_deg", "phi_f_deg", "duration", "peak", "phi_i_down_deg", "phi_i_up_deg", "phi_f_down_deg",
              "phi_f_up_deg", "duration_down", "duration_up", "tolerant_peak", "one_degree", "ten_milliseconds",
              "one_centimetre", "pitch_one_degree", "damping_ten_percent"});
  std::vector<std::vector<std::string>> rows;
  for (const Basin& b : found) {
    const Evidence e = evidence(scene, actuator.sea, b.motion,
                                {.accuracy = options.tight, .threads = common.threads, .monitor = {{}, interrupted}});
    run.progress("map: evidence", long(rows.size()) + 1, long(found.size()));
    csv.cell(b.motion.phi_i * kDegrees).cell(b.motion.phi_f * kDegrees).cell(b.motion.duration).cell(b.peak);
    for (std::size_t k = 0; k < 3; ++k)
      for (const double w : e.width[k]) csv.cell(w * (k < 2 ? kDegrees : 1));
    csv.cell(e.tolerant.value).cell(e.one_degree).cell(e.ten_milliseconds).cell(e.one_centimetre);
    csv.cell(e.pitch_one_degree).cell(e.damping_ten_percent).end_row();
    const auto both = [](const std::array<double, 2>& w, double unit) {
      return fmt::format("-{:.2g} +{:.2g}", w[0] * unit, w[1] * unit);
    };
    rows.push_back(
        {fmt::format("{:.3f}, {:.3f}, {:.4f}", b.motion.phi_i * kDegrees, b.motion.phi_f * kDegrees, b.motion.duration),
         fmt::format("{:.2f}", b.peak), both(e.width[0], kDegrees), both(e.width[1], kDegrees), both(e.width[2], 1e3),
         fmt::format("{:.1f}", e.tolerant.value), fmt::format("{:.0f}", e.one_degree),
         fmt::format("{:.0f}", e.ten_milliseconds), fmt::format("{:.0f}", e.one_centimetre),
         fmt::format("{:.0f}", e.pitch_one_degree), fmt::format("{:.0f}", e.damping_ten_percent)});
    Json basin = {{"motion", motion_json(b.motion)}, {"peak_acceleration", number(b.peak)}};
    basin.update(evidence_json(e));
    summary["basins"].push_back(basin);
  }
  run.add("basins.csv", csv.text());
  const Basin& best = found.front();
  run.say(fmt::format("{} landings in {:.2f} s; {} basins", map.grid.size(), map_seconds, found.size()));
  for (const auto& row : rows) run.say(fmt::format("  ({})  peak {}  tolerant {}", row[0], row[1], row[5]));

  Report report("The box of motions: " + scene.name);
  if (!scene.floor_source.empty()) report.paragraph("Floor constants: " + scene.floor_source + ".");
  report.paragraph(fmt::format("{} landings in {:.2f} s. The best found: {:.4f} m/s² at ({}).", map.grid.size(),
                               map_seconds, best.peak, rows.front()[0]));
  report.heading("Smallest peak over the third variable [m/s²]");
  report.heatmap(projection(map, 0, 1, 2));
  report.heatmap(projection(map, 0, 2, 1));
  report.heatmap(projection(map, 1, 2, 0));
  report.heading("Basins");
  report.paragraph(
      "How far each variable may move before the peak rises by 5 %, and the worst peaks under deviations.");
  report.table({"motion [deg, deg, s]", "peak", "phi_I [deg]", "phi_F [deg]", "duration [ms]", "tolerant", "1 deg",
                "10 ms", "1 cm", "pitch 1 deg", "damping 10 %"},
               rows);
  report.list(run.warnings());
  run.add("report.html", report.html(run.provenance()));
  return run.finish(summary, kDone);
}

}  // namespace

void add_map(CLI::App& app, Action& chosen) {
  auto args = std::make_shared<MapArguments>();
  auto common = std::make_shared<CommonOptions>();
  CLI::App* verb = app.add_subcommand("map", "the whole box of motions on a grid, and its basins");
  verb->add_option("SCENE", args->scene, "scene file (TOML)")->required();
  verb->add_option("--actuator", args->actuator, "actuator file (TOML)")->required();
  verb->add_option("--grid", args->grid, "points of phi_I, phi_F and duration [64,64,32]")->delimiter(',');
  verb->add_option("--polish", args->polish, "how many of the grid's local minima are searched from close by [24]");
  add_common(*verb, *common);
  verb->footer("Example: ukemi map scene.toml --actuator actuator.toml --grid 64,64,32 -o out");
  verb->callback([args, common, &chosen] { chosen = [args, common] { return run_map(*args, *common); }; });
}

}  // namespace ukemi::tools

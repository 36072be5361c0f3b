// ukemi bench stability: stiff and extreme landings, and fits of stiff and extreme data, each with its map.
#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <numeric>

#include "common/actuator.hpp"
#include "common/parallel.hpp"
#include "common/stopwatch.hpp"
#include "landing/model/scene_file.hpp"
#include "tools/bench/bench.hpp"
#include "tools/bench/stability.hpp"
#include "tools/report/report.hpp"

namespace ukemi::tools {

namespace {

using landing::StabilityCase;
using landing::StabilityResult;
using landing::Verdict;

/// How many landings of a group received each verdict.
struct Tally {
  std::string group;
  std::array<int, 5> counts{};  ///< by Verdict

  int& of(Verdict v) { return counts[std::size_t(v)]; }
  int of(Verdict v) const { return counts[std::size_t(v)]; }
  int all() const { return std::accumulate(counts.begin(), counts.end(), 0); }
};
Quantities<Tally> tally_quantities(const char* group) {
  Quantities<Tally> out = {{"", "", group, {}, &Tally::group}, {"", "cases", "cases", {}, &Tally::all}};
  for (const Verdict v : {Verdict::kPass, Verdict::kSensitive, Verdict::kRefused, Verdict::kWrong})
    out.push_back({"", name(v), name(v), {}, [v](const Tally& t) { return t.of(v); }});
  return out;
}

/// A landing of the grid, its result and run time.
struct GridResult : StabilityCase, StabilityResult {
  double seconds = 0;  ///< processor time
};
const Quantities<GridResult> kGridQuantities = {
    {"factor", "", "factor", {}, &GridResult::factor},
    {"setting", "", "setting", {}, [](auto& r) { return in_quotes(r.setting); }},
    {"verdict", "", "verdict", {}, [](auto& r) { return name(r.verdict); }},
    {"reason", "", "why", {}, [](auto& r) { return in_quotes(r.reason); }},
    {"peak", "", &GridResult::peak},
    {"energy_residual", "", "energy", "{:.1e}", &GridResult::energy_residual},
    {"halving", "", "halving", "{:.1e}", &GridResult::halving},
    {"sensitivity", "", "change for 1e-6", "{:.1e}", &GridResult::sensitivity},
    {"steps", "", [](auto& r) { return r.work.steps; }},
    {"implicit_steps", "", [](auto& r) { return r.work.implicit; }},
    {"events", "", [](auto& r) { return r.work.events; }},
    {"time_s", "", &GridResult::seconds},
};

std::vector<GridResult> grid_results(const BenchArguments& a, const Run& run) {
  using namespace landing;
  const std::vector<StabilityCase> grid =
      stability_grid(read_scene(dataset("scenes/paper.toml")), read_actuator(dataset("actuators/table2.toml")).sea,
                     a.random, run.options().seed);
  std::vector<GridResult> out(grid.size());
  std::mutex mutex;
  long done = 0;
  parallel_for(int(grid.size()), run.options().threads, [&](int i) {
    const StabilityCase& c = grid[std::size_t(i)];
    GridResult& r = out[std::size_t(i)];
    static_cast<StabilityCase&>(r) = c, static_cast<StabilityResult&>(r) = check_stability(c);
    const Stopwatch watch(Stopwatch::Time::kProcessor);
    (void)peak_acceleration(c.scene, c.sea, c.motion, {.max_steps = StabilityLimits{}.max_steps});
    r.seconds = watch.seconds();
    const std::lock_guard lock(mutex);
    run.progress("bench", "landings", ++done, long(grid.size()));
  });
  return out;
}

Json landings(const BenchArguments& a, Run& run, Report& report) {
  const std::vector<GridResult> results = grid_results(a, run);
  Tally all{"all"};
  std::vector<Tally> map;
  double worst_energy = 0, worst_halving = 0, longest = 0;
  long most_steps = 0;
  std::vector<GridResult> notable;
  for (const GridResult& r : results) {
    if (map.empty() || map.back().group != r.factor) map.push_back({r.factor});
    ++map.back().of(r.verdict), ++all.of(r.verdict);
    if (r.verdict != Verdict::kRefused) worst_energy = std::max(worst_energy, r.energy_residual);
    if (r.verdict == Verdict::kPass)
      worst_halving = std::max(worst_halving, r.halving);
    else
      notable.push_back(r);
    longest = std::max(longest, r.seconds), most_steps = std::max(most_steps, r.work.steps);
  }
  map.push_back(all);
  run.add("stability.csv", Table(kGridQuantities, results)
                               .csv(run,
                                    "peak [m/s^2]; energy_residual: over the energy turned over; halving: relative "
                                    "change of the peak with half the tolerance; sensitivity: relative change with the "
                                    "scene moved by 1e-6, measured where halving fails; time_s of a landing."));
  report.heading("Landings");
  (void)add_table(Table(tally_quantities("factor"), map), report, run);
  const std::string worst = fmt::format(
      "Worst energy residual of those followed {:.1e}, largest change by halving of those that pass {:.1e}; at most {} "
      "steps, {:.2f} s a landing.",
      worst_energy, worst_halving, most_steps, longest);
  run.say(worst), report.paragraph(worst);
  report.heading("Landings that do not pass");
  report.table(Table(kGridQuantities, notable));
  Json out = Table::of(tally_quantities(""), all).object();
  out["worst_energy_residual"] = worst_energy, out["most_steps"] = most_steps;
  return out;
}

}  // namespace

int bench_stability(const BenchArguments& a, const CommonOptions& common) {
  Run run(Outputs{"bench stability", {"stability.csv", "stability_identify.csv"}, {}}, common);
  Report report("Stability: stiff and extreme cases");
  const Json of_landings = landings(a, run, report), of_fits = stability_of_fits(run, report);
  const int wrong = of_landings["wrong"].get<int>() + of_fits["wrong"].get<int>();
  if (wrong > 0) run.warn(fmt::format("{} cases are silently wrong", wrong));
  const int cases = of_landings["cases"].get<int>(), pass = of_landings["pass"].get<int>();
  report.answer(
      {fmt::format(
           "{} of {} stiff and extreme landings pass, {} are refused or called sensitive, {} are silently wrong.", pass,
           cases, cases - pass - of_landings["wrong"].get<int>(), of_landings["wrong"].get<int>()),
       {check(wrong == 0, "never silently wrong", fmt::format("{} landings and fits are", wrong))},
       "What is refused says why; a sensitive landing stands beside a cliff of its scene."},
      run.warnings());
  report.write(run);
  return run.finish({{"landings", of_landings}, {"fits", of_fits}}, wrong > 0 ? kNumbers : kDone);
}

}  // namespace ukemi::tools

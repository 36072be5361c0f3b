// ukemi bench optimizers: every solver on ten scenes and both goals, the gap to the best known against time and
// against motions evaluated.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <span>
#include <tuple>

#include "common/actuator.hpp"
#include "common/error.hpp"
#include "common/median.hpp"
#include "common/parallel.hpp"
#include "landing/model/scene_file.hpp"
#include "landing/search/optimize.hpp"
#include "landing/search/solvers.hpp"
#include "tools/bench/bench.hpp"
#include "tools/program/arguments.hpp"
#include "tools/report/report.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

constexpr auto& kScenes = kShippedScenes;
constexpr std::array<const char*, 2> kGoals = {"peak", "tolerant"};
constexpr std::array<double, 5> kMarks = {100, 300, 1'000, 5'000, 20'000};
constexpr double kNothing = std::numeric_limits<double>::infinity();  ///< the gap of a search that found nothing
constexpr double kLevel = 0.002;                                      ///< two gaps this near are level
constexpr double kDrawn = 1e-5;                                       ///< smaller ones are drawn there

/// What a row of optimizers.csv tells of a search; after_N: its best after N motions, by its own accuracy. Nothing
/// found, or not known: NaN, an empty cell.
enum Found { kTime, kEvaluations, kLandings, kValue, kPhiI, kPhiF, kDuration, kAfter, kFound = kAfter + kMarks.size() };
constexpr std::array<const char*, kFound> kColumns = {"time_s",    "evaluations", "landings",   "value",
                                                      "phi_i_deg", "phi_f_deg",   "duration",   "after_100",
                                                      "after_300", "after_1000",  "after_5000", "after_20000"};

/// One search by one solver on one core.
struct Trial {
  std::size_t scene, goal;
  std::string solver;
  std::uint64_t seed;
  double budget;  ///< [s]
  std::array<double, kFound> found;

  bool operator<(const Trial& o) const { return key() < o.key(); }
  std::tuple<std::size_t, std::size_t, const std::string&, std::uint64_t, double> key() const {
    return {scene, goal, solver, seed, budget};
  }
};

std::array<double, kFound> search(const Trial& t, const Scene& scene, const SeaParameters<double>& sea) {
  OptimizeOptions o;
  o.solver = t.solver, o.goal = Goal(int(t.goal)), o.deadline = t.budget, o.threads = 1;
  o.time = Stopwatch::Time::kProcessor;
  o.seed = t.seed, o.tolerance_samples = 0;
  const Optimum r = optimize(scene, sea, o);
  std::array<double, kFound> found;
  found.fill(std::numeric_limits<double>::quiet_NaN());
  found[kTime] = r.seconds, found[kEvaluations] = double(r.evaluations), found[kLandings] = double(r.landings);
  for (const Progress& p : r.progress)
    for (std::size_t m = 0; m < kMarks.size(); ++m)
      if (double(p.motions) <= kMarks[m] && p.best.value < kNoMotion) found[kAfter + m] = p.best.value;
  if (!r.found) return found;
  found[kValue] = r.value, found[kDuration] = r.motion.duration;
  found[kPhiI] = r.motion.phi_i * kDegrees, found[kPhiF] = r.motion.phi_f * kDegrees;
  return found;
}

std::size_t one_of(std::span<const char* const> names, const std::string& name, const Location& where) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    throw InputError(where, fmt::format("'{}': one of {} is needed", name, fmt::join(names, ", ")));
  return std::size_t(found - names.begin());
}

std::size_t column(const CsvTable& table, const char* name) { return std::size_t(table.require(name)); }

std::uint64_t seed_at(const CsvTable& table, std::size_t c, std::size_t row) {
  const std::string& cell = table.texts[c][row];
  if (cell.empty()) throw InputError(table.at(int(c), row), "column 'seed': empty: a whole number is needed");
  return to_seed(table.at(int(c), row).text() + ": column 'seed'", cell);
}

/// The searches that an earlier run's optimizers.csv holds.
std::vector<Trial> read_trials(const std::string& path) {
  const CsvTable table = read_csv(path, [](const std::string&) { return true; }, NanCells::kRefused,
                                  {"scene", "objective", "solver", "seed"});
  const std::size_t scene = column(table, "scene"), goal = column(table, "objective"), solver = column(table, "solver"),
                    seed = column(table, "seed"), budget = column(table, "budget_s");
  column(table, kColumns[kValue]);
  table.require_full(int(budget));
  std::vector<Trial> trials;
  for (std::size_t i = 0; i < table.rows(); ++i) {
    Trial t{one_of(kScenes, table.texts[scene][i], table.at(int(scene), i)),
            one_of(kGoals, table.texts[goal][i], table.at(int(goal), i)),
            table.texts[solver][i],
            seed_at(table, seed, i),
            table.columns[budget][i],
            {}};
    for (std::size_t k = 0; k < kFound; ++k) {
      const int c = table.find(kColumns[k]);
      t.found[k] = c < 0 ? std::numeric_limits<double>::quiet_NaN() : table.columns[std::size_t(c)][i];
    }
    trials.push_back(t);
  }
  return trials;
}

/// The best that any search has found, ours or an earlier one's: [scene][goal], datasets/best_known.csv.
using BestKnown = std::array<std::array<double, kGoals.size()>, kScenes.size()>;
BestKnown best_known(const std::string& path) {
  const CsvTable table = read_csv(path, [](const std::string&) { return true; }, NanCells::kRefused, {"scene"});
  if (table.rows() != kScenes.size()) throw InputError(path + ": a row for each of the ten scenes is needed");
  const std::size_t scene = column(table, "scene");
  for (const char* goal : kGoals) table.require_full(table.require(goal));
  BestKnown best{};
  std::array<bool, kScenes.size()> known{};
  for (std::size_t i = 0; i < table.rows(); ++i) {
    const Location where = table.at(int(scene), i);
    const std::size_t s = one_of(kScenes, table.texts[scene][i], where);
    if (std::exchange(known[s], true)) throw InputError(where, quoted(kScenes[s]) + ": the scene is given twice");
    for (std::size_t g = 0; g < kGoals.size(); ++g) best[s][g] = table.columns[column(table, kGoals[g])][i];
  }
  return best;
}

/// What is asked for.
struct Cases {
  std::vector<std::string> solvers;
  std::vector<double> times;  ///< [s], increasing
  std::uint64_t first_seed;
  int seeds;
};

/// Every search of the cases; those of `earlier` runs are taken from there.
std::vector<Trial> searched(const Cases& cases, std::vector<Trial> earlier, const Run& run) {
  std::stable_sort(earlier.begin(), earlier.end());
  std::vector<Trial> trials;
  std::vector<std::size_t> open;
  double seconds = 0;
  for (std::size_t scene = 0; scene < kScenes.size(); ++scene)
    for (std::size_t goal = 0; goal < kGoals.size(); ++goal)
      for (const std::string& solver : cases.solvers)
        for (int s = 0; s < cases.seeds; ++s)
          for (const double t : cases.times) {
            trials.push_back({scene, goal, solver, cases.first_seed + std::uint64_t(s), t, {}});
            const auto same = std::lower_bound(earlier.begin(), earlier.end(), trials.back());
            if (same != earlier.end() && same->key() == trials.back().key())
              trials.back() = *same;
            else
              open.push_back(trials.size() - 1), seconds += t;
          }
  run.info(fmt::format("{} searches, {} from earlier runs; about {:.0f} s on one core", trials.size(),
                       trials.size() - open.size(), seconds));
  const Actuator actuator = read_actuator(dataset("actuators/table2.toml"));
  std::vector<Scene> scenes;
  for (const char* name : kScenes) scenes.push_back(read_scene(dataset(fmt::format("scenes/{}.toml", name))));
  std::mutex mutex;
  long done = 0;
  parallel_for(int(open.size()), run.options().threads, [&](int i) {
    Trial& t = trials[open[std::size_t(i)]];
    t.found = search(t, scenes[t.scene], actuator.sea);
    const std::lock_guard lock(mutex);
    run.progress("searches", ++done, long(open.size()));
  });
  return trials;
}

double gap_of(const Trial& t, std::size_t column, const BestKnown& best) {
  return std::isnan(t.found[column]) ? kNothing : t.found[column] / best[t.scene][t.goal] - 1;
}

/// Gaps of one solver for one goal: by budget or mark, then by scene; those of all seeds.
using Gaps = std::vector<std::array<std::vector<double>, kScenes.size()>>;
using GapsOfSolvers = std::map<std::string, Gaps>;
struct AllGaps {
  std::array<GapsOfSolvers, kGoals.size()> after_time, after_motions;
};
AllGaps gaps_of(const std::vector<Trial>& trials, const std::vector<double>& times, const BestKnown& best) {
  AllGaps gaps;
  for (const Trial& t : trials) {
    Gaps& by_time = gaps.after_time[t.goal][t.solver];
    by_time.resize(times.size());
    const auto k = std::find(times.begin(), times.end(), t.budget) - times.begin();
    by_time[std::size_t(k)][t.scene].push_back(gap_of(t, kValue, best));
    Gaps& by_motions = gaps.after_motions[t.goal][t.solver];
    by_motions.resize(kMarks.size());
    const bool told = std::isnan(t.found[kValue]) || !std::isnan(t.found[kAfter + kMarks.size() - 1]);
    if (t.budget == times.back() && told)
      for (std::size_t m = 0; m < kMarks.size(); ++m) by_motions[m][t.scene].push_back(gap_of(t, kAfter + m, best));
  }
  return gaps;
}

/// Of one solver on one scene, over the seeds.
struct Range {
  double middle, least, largest;
};
Range range_of(const std::vector<double>& seeds) {
  const auto [low, high] = std::minmax_element(seeds.begin(), seeds.end());
  return {median(seeds), *low, *high};
}

/// optimizers.csv: every search; gaps.csv: median and range over the seeds; best_known.csv.
void add_files(Run& run, const std::vector<Trial>& trials, const Cases& cases, const AllGaps& gaps,
               const BestKnown& best) {
  CsvWriter csv = run.csv(), ranges = run.csv(), known = run.csv();
  std::vector<std::string> header = {"scene", "objective", "solver", "seed", "budget_s", "gap"};
  header.insert(header.end(), kColumns.begin(), kColumns.end());
  csv.header(header);
  for (const Trial& t : trials) {
    csv.cell(kScenes[t.scene]).cell(kGoals[t.goal]).cell(t.solver).cell(std::to_string(t.seed)).cell(t.budget);
    csv.cell(gap_of(t, kValue, best));
    for (const double x : t.found) csv.cell(x);
    csv.end_row();
  }
  ranges.comment("The gap to the best known over the seeds of each search; nothing found: empty.");
  ranges.header({"scene", "objective", "solver", "budget_s", "seeds", "median", "least", "largest"});
  for (std::size_t scene = 0; scene < kScenes.size(); ++scene)
    for (std::size_t goal = 0; goal < kGoals.size(); ++goal)
      for (const std::string& solver : cases.solvers)
        for (std::size_t k = 0; k < cases.times.size(); ++k) {
          const std::vector<double>& seeds = gaps.after_time[goal].at(solver)[k][scene];
          const Range r = range_of(seeds);
          ranges.cell(kScenes[scene]).cell(kGoals[goal]).cell(solver).cell(cases.times[k]).cell(long(seeds.size()));
          ranges.cell(r.middle).cell(r.least).cell(r.largest).end_row();
        }
  known.header({"scene", "peak", "tolerant"});
  for (std::size_t i = 0; i < kScenes.size(); ++i) known.cell(kScenes[i]).cell(best[i][0]).cell(best[i][1]).end_row();
  run.add("optimizers.csv", csv.text());
  run.add("gaps.csv", ranges.text());
  run.add("best_known.csv", known.text());
}

std::string percent(double gap, int digits) {
  return gap < kNothing ? fmt::format("{:.{}f} %", 100 * gap, digits) : "nothing";
}

/// The best of the others on a scene, by the median over seeds.
std::pair<std::string, double> best_other(const GapsOfSolvers& gaps, std::size_t k, std::size_t scene) {
  std::pair<std::string, double> best{"none", kNothing};
  for (const auto& [solver, of] : gaps)
    if (const double m = median(of[k][scene]); solver != "auto" && m < best.second) best = {solver, m};
  return best;
}

/// auto beside the best other, scene by scene, for the report. Returns on how many scenes it is ahead or level, by
/// budget.
std::vector<int> beside_others(Report& report, const GapsOfSolvers& gaps, const std::vector<double>& times) {
  std::vector<std::string> header = {"scene"};
  for (const double t : times) header.push_back(fmt::format("{:g} s", t));
  std::vector<int> leads(times.size(), 0);
  std::vector<std::vector<std::string>> rows;
  for (std::size_t scene = 0; scene < kScenes.size(); ++scene) {
    rows.push_back({kScenes[scene]});
    for (std::size_t k = 0; k < times.size(); ++k) {
      const Range ours = range_of(gaps.at("auto")[k][scene]);
      const auto [other, gap] = best_other(gaps, k, scene);
      leads[k] += ours.middle <= gap + kLevel;
      rows.back().push_back(fmt::format("{} [{}, {}]; {} {}", percent(ours.middle, 2), percent(ours.least, 2),
                                        percent(ours.largest, 2), other, percent(gap, 2)));
    }
  }
  report.paragraph("auto's median [range] over the seeds, and the best of the others by its median:");
  report.table(header, rows);
  return leads;
}

/// A table and a plot of the medians, over seeds and then over scenes, against `x`: into the report, the table to the
/// terminal and the plot to NAME.svg too. Returns the medians, by solver; null where a scene has none, or nothing was
/// found.
Json show(Report& report, Run& run, const std::string& name, const std::vector<std::string>& solvers,
          const GapsOfSolvers& gaps, std::span<const double> x, const std::string& unit, const std::string& x_label) {
  std::vector<std::string> header = {"solver"};
  for (const double at : x) header.push_back(fmt::format("{:g} {}", at, unit));
  std::vector<std::vector<std::string>> rows;
  std::vector<Series> curves;
  Json json;
  for (const std::string& solver : solvers) {
    rows.push_back({solver}), curves.push_back({solver, {}, {}});
    for (std::size_t k = 0; k < x.size(); ++k) {
      std::vector<double> of_scenes;
      for (const std::vector<double>& seeds : gaps.at(solver)[k])
        if (!seeds.empty()) of_scenes.push_back(median(seeds));
      const bool told = of_scenes.size() == kScenes.size();
      const double middle = told ? median(of_scenes) : kNothing;
      json[solver].push_back(number(middle));
      rows.back().push_back(told ? fmt::format("{} ({})", percent(middle, 2),
                                               percent(*std::max_element(of_scenes.begin(), of_scenes.end()), 0))
                                 : "");
      if (std::isfinite(middle))
        curves.back().x.push_back(x[k]), curves.back().y.push_back(100 * std::max(kDrawn, middle));
    }
  }
  report.table(header, rows);
  const std::string plot = report.plot(x_label, "gap to the best known [%]", curves, Axes::kLogarithmic);
  if (!plot.empty()) run.add(name + ".svg", plot);
  run.say("  " + fmt::format("{}", fmt::join(header, "  ")));
  for (const auto& row : rows) run.say(fmt::format("  {}", fmt::join(row, "  ")));
  return json;
}

}  // namespace

int bench_optimizers(const BenchArguments& arguments, const CommonOptions& common) {
  Run run("bench optimizers", common);
  Cases cases{arguments.solvers, arguments.times, common.seed, arguments.seeds};
  if (cases.solvers.empty()) cases.solvers = solver_names();
  for (const std::string& s : cases.solvers) check_solver(s);
  std::vector<double>& times = cases.times;
  if (times.empty()) times = {0.03, 0.1, 0.3, 1};
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  BestKnown best = best_known(dataset("best_known.csv"));
  std::vector<Trial> earlier;
  for (const std::string& path : arguments.with) {
    run.input(path);
    for (const Trial& t : read_trials(path)) earlier.push_back(t);
  }
  const std::vector<Trial> trials = searched(cases, std::move(earlier), run);
  for (const Trial& t : trials)
    if (t.found[kValue] < best[t.scene][t.goal]) best[t.scene][t.goal] = t.found[kValue];
  const AllGaps gaps = gaps_of(trials, times, best);
  add_files(run, trials, cases, gaps, best);

  Report report("Solvers");
  report.paragraph(fmt::format(
      "Gap to the best known of ten scenes: for each scene the median over {} seeds, then the median over the scenes "
      "(in brackets the largest); one core's own time, verification included.",
      arguments.seeds));
  Json summary;
  for (std::size_t goal = 0; goal < kGoals.size(); ++goal) {
    report.heading(kGoals[goal]), run.say(fmt::format("{}:", kGoals[goal]));
    Json& of_goal = summary[kGoals[goal]];
    of_goal["gaps"] = show(report, run, fmt::format("{}_time", kGoals[goal]), cases.solvers, gaps.after_time[goal],
                           times, "s", "time of one core [s]");
    if (gaps.after_time[goal].count("auto")) {
      of_goal["auto_leads"] = beside_others(report, gaps.after_time[goal], times);
      const std::string leads = fmt::format("of ten scenes auto leads, or is level, on {}",
                                            fmt::join(of_goal["auto_leads"].get<std::vector<int>>(), ", "));
      report.paragraph(leads), run.say("  " + leads);
    }
    report.paragraph(
        "The same against motions evaluated, from the searches of the longest budget, at the accuracy of the search. "
        "NLopt's solvers ask for one motion at a time.");
    of_goal["gaps_after"] = show(report, run, fmt::format("{}_motions", kGoals[goal]), cases.solvers,
                                 gaps.after_motions[goal], kMarks, "motions", "motions evaluated");
  }
  summary["times"] = times, summary["seeds"] = arguments.seeds;
  run.add("report.html", report.html(run.provenance()));
  return run.finish(summary, kDone);
}

}  // namespace ukemi::tools

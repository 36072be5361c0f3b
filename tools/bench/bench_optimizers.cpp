// ukemi bench optimizers: every solver on ten scenes and both goals, the gap to the best known against time and
// against motions evaluated.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <span>

#include "common/median.hpp"
#include "common/toml.hpp"
#include "landing/search/solvers.hpp"
#include "tools/bench/bench_searches.hpp"
#include "tools/report/report.hpp"

namespace ukemi::tools {

namespace {

constexpr double kNotFound = std::numeric_limits<double>::infinity();  ///< the gap of a search that found nothing
constexpr double kLevel = 0.002;                                       ///< a smaller difference of two gaps is a tie
constexpr double kSmallestDrawn = 1e-5;                                ///< smaller gaps are plotted at this

double gap_of(const SearchRun& t, std::size_t column, const BestKnown& best) {
  return std::isnan(t.result[column]) ? kNotFound : t.result[column] / best[t.scene][t.goal] - 1;
}

/// Gaps of one solver for one goal: [budget or motion count][scene], a value for each seed.
using Gaps = std::vector<std::array<std::vector<double>, kScenes.size()>>;
using GapsOfSolvers = std::map<std::string, Gaps>;
struct AllGaps {
  std::array<GapsOfSolvers, kGoalNames.size()> after_time, after_motions;
};
AllGaps gaps_of(const std::vector<SearchRun>& searches, const std::vector<double>& times, const BestKnown& best) {
  AllGaps gaps;
  for (const SearchRun& t : searches) {
    Gaps& by_time = gaps.after_time[t.goal][t.solver];
    by_time.resize(times.size());
    const auto k = std::find(times.begin(), times.end(), t.budget) - times.begin();
    by_time[std::size_t(k)][t.scene].push_back(gap_of(t, kValue, best));
    Gaps& by_count = gaps.after_motions[t.goal][t.solver];
    by_count.resize(kMotions.size());
    const bool known = std::isnan(t.result[kValue]) || !std::isnan(t.result[kAfter + kMotions.size() - 1]);
    if (t.budget == times.back() && known)
      for (std::size_t m = 0; m < kMotions.size(); ++m) by_count[m][t.scene].push_back(gap_of(t, kAfter + m, best));
  }
  return gaps;
}

/// The gaps of one solver with one budget on one scene, over the seeds; nothing found: infinite.
struct GapRange {
  std::string scene, goal, solver;
  double budget;
  std::size_t seeds;
  double median, lowest, highest;
};
const Quantities<GapRange> kRangeQuantities = {{"scene", "", &GapRange::scene},   {"objective", "", &GapRange::goal},
                                               {"solver", "", &GapRange::solver}, {"budget_s", "", &GapRange::budget},
                                               {"seeds", "", &GapRange::seeds},   {"median", "", &GapRange::median},
                                               {"least", "", &GapRange::lowest},  {"largest", "", &GapRange::highest}};
GapRange range_of(const std::vector<double>& gaps, GapRange labels = {}) {
  const auto [low, high] = std::minmax_element(gaps.begin(), gaps.end());
  labels.seeds = gaps.size(), labels.median = median(gaps), labels.lowest = *low, labels.highest = *high;
  return labels;
}

Quantities<SearchRun> search_quantities(const BestKnown& best) {
  Quantities<SearchRun> out = {{"scene", "", [](auto& t) { return kScenes[t.scene]; }},
                               {"objective", "", [](auto& t) { return kGoalNames[t.goal]; }},
                               {"solver", "", &SearchRun::solver},
                               {"seed", "", [](auto& t) { return std::to_string(t.seed); }},
                               {"budget_s", "", &SearchRun::budget},
                               {"gap", "", [&best](auto& t) { return gap_of(t, kValue, best); }}};
  for (std::size_t k = 0; k < kResults; ++k) out.push_back({kColumns[k], "", [k](auto& t) { return t.result[k]; }});
  return out;
}

/// optimizers.csv: every search; gaps.csv: median and range over the seeds; best_known.csv.
void add_files(Run& run, const std::vector<SearchRun>& searches, const SearchPlan& plan, const AllGaps& gaps,
               const BestKnown& best) {
  run.add("optimizers.csv", Table(search_quantities(best), searches).csv(run));
  std::vector<GapRange> ranges;
  for (std::size_t scene = 0; scene < kScenes.size(); ++scene)
    for (std::size_t goal = 0; goal < kGoalNames.size(); ++goal)
      for (const std::string& solver : plan.solvers)
        for (std::size_t k = 0; k < plan.times.size(); ++k)
          ranges.push_back(range_of(gaps.after_time[goal].at(solver)[k][scene],
                                    {kScenes[scene], kGoalNames[goal], solver, plan.times[k]}));
  run.add("gaps.csv", Table(kRangeQuantities, ranges)
                          .csv(run, "The gap to the best known over the seeds of each search; nothing found: empty."));
  CsvWriter known = run.csv();
  known.header({"scene", "peak", "tolerant"});
  for (std::size_t i = 0; i < kScenes.size(); ++i) known.cell(kScenes[i]).cell(best[i][0]).cell(best[i][1]).end_row();
  run.add("best_known.csv", known.text());
}

std::string percent(double gap, int digits) {
  return gap < kNotFound ? fmt::format("{:.{}f} %", 100 * gap, digits) : "nothing";
}

/// The solver other than auto with the lowest median gap over the seeds on a scene, and that gap.
std::pair<std::string, double> best_other(const GapsOfSolvers& gaps, std::size_t k, std::size_t scene) {
  std::pair<std::string, double> best{"none", kNotFound};
  for (const auto& [solver, by_scene] : gaps)
    if (const double m = median(by_scene[k][scene]); solver != "auto" && m < best.second) best = {solver, m};
  return best;
}

/// Reports auto next to the best other solver, scene by scene. Returns for each budget on how many scenes auto leads or
/// ties.
std::vector<int> compare_with_others(Report& report, const GapsOfSolvers& gaps, const std::vector<double>& times) {
  std::vector<std::string> header = {"scene"};
  for (const double t : times) header.push_back(fmt::format("{:g} s", t));
  std::vector<int> leads(times.size(), 0);
  std::vector<std::vector<std::string>> rows;
  for (std::size_t scene = 0; scene < kScenes.size(); ++scene) {
    rows.push_back({kScenes[scene]});
    for (std::size_t k = 0; k < times.size(); ++k) {
      const GapRange ours = range_of(gaps.at("auto")[k][scene]);
      const auto [other, gap] = best_other(gaps, k, scene);
      leads[k] += ours.median <= gap + kLevel;
      rows.back().push_back(fmt::format("{} [{}, {}]; {} {}", percent(ours.median, 2), percent(ours.lowest, 2),
                                        percent(ours.highest, 2), other, percent(gap, 2)));
    }
  }
  report.paragraph("auto's median [range] over the seeds, and the best of the others by its median:");
  report.table(header, rows);
  return leads;
}

/// Reports a table and a plot of the medians, over seeds and then over scenes, against `x`; prints the table and writes
/// the plot to NAME.svg. Returns the medians by solver; null where a scene has none, or nothing was found.
Json show(Report& report, Run& run, const std::string& name, const std::vector<std::string>& solvers,
          const GapsOfSolvers& gaps, std::span<const double> x, const std::string& unit, const std::string& x_label) {
  std::vector<std::string> header = {"solver"};
  for (const double value : x) header.push_back(fmt::format("{:g} {}", value, unit));
  std::vector<std::vector<std::string>> rows;
  std::vector<Series> curves;
  Json json;
  for (const std::string& solver : solvers) {
    rows.push_back({solver}), curves.push_back({solver, {}, {}});
    for (std::size_t k = 0; k < x.size(); ++k) {
      std::vector<double> medians;
      for (const std::vector<double>& seeds : gaps.at(solver)[k])
        if (!seeds.empty()) medians.push_back(median(seeds));
      const bool complete = medians.size() == kScenes.size();
      const double overall = complete ? median(medians) : kNotFound;
      json[solver].push_back(number(overall));
      rows.back().push_back(complete ? fmt::format("{} ({})", percent(overall, 2),
                                                   percent(*std::max_element(medians.begin(), medians.end()), 0))
                                     : "");
      if (std::isfinite(overall))
        curves.back().x.push_back(x[k]), curves.back().y.push_back(100 * std::max(kSmallestDrawn, overall));
    }
  }
  report.table(header, rows);
  report.plot(name, x_label, "gap to the best known [%]", curves, Axes::kLogarithmic);
  run.say("  " + fmt::format("{}", fmt::join(header, "  ")));
  for (const auto& row : rows) run.say(fmt::format("  {}", fmt::join(row, "  ")));
  return json;
}

/// The solvers and times of the options, else the default ones.
SearchPlan plan_of(const BenchArguments& arguments, std::uint64_t seed) {
  SearchPlan plan{arguments.solvers, arguments.times, seed, arguments.seeds};
  if (plan.solvers.empty()) {
    plan.solvers = landing::solver_names();
    std::erase(plan.solvers, "cma");  // it is for more variables than these scenes have
  }
  for (const std::string& s : plan.solvers) landing::check_solver(s);
  std::vector<double>& times = plan.times;
  if (times.empty()) times = {0.03, 0.1, 0.3, 1};
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return plan;
}

/// Reports the gaps of one goal, after a time and after a number of motions.
Json show_goal(std::size_t goal, const SearchPlan& plan, const AllGaps& gaps, Report& report, Run& run) {
  report.heading(kGoalNames[goal]), run.say(fmt::format("{}:", kGoalNames[goal]));
  Json json;
  json["gaps"] = show(report, run, fmt::format("{}_time", kGoalNames[goal]), plan.solvers, gaps.after_time[goal],
                      plan.times, "s", "time of one core [s]");
  if (gaps.after_time[goal].count("auto")) {
    json["auto_leads"] = compare_with_others(report, gaps.after_time[goal], plan.times);
    const std::string leads = fmt::format("of ten scenes auto leads, or is level, on {}",
                                          fmt::join(json["auto_leads"].get<std::vector<int>>(), ", "));
    report.paragraph(leads), run.say("  " + leads);
  }
  report.paragraph(
      "The same against motions evaluated, from the searches of the longest budget, at the accuracy of the search. "
      "NLopt's solvers evaluate one motion at a time.");
  json["gaps_after"] = show(report, run, fmt::format("{}_motions", kGoalNames[goal]), plan.solvers,
                            gaps.after_motions[goal], kMotions, "motions", "motions evaluated");
  return json;
}

}  // namespace

int bench_optimizers(const BenchArguments& arguments, const CommonOptions& common) {
  Run run(Outputs{"bench optimizers",
                  {"optimizers.csv", "gaps.csv", "best_known.csv"},
                  {"peak_time", "peak_motions", "tolerant_time", "tolerant_motions"}},
          common);
  const SearchPlan plan = plan_of(arguments, common.seed);
  const std::vector<double>& times = plan.times;
  BestKnown best = best_known(dataset("best_known.csv"));
  std::vector<SearchRun> earlier;
  for (const std::string& path : arguments.with) {
    run.input(path);
    for (const SearchRun& t : read_searches(path)) earlier.push_back(t);
  }
  const std::vector<SearchRun> searches = run_searches(plan, std::move(earlier), run);
  for (const SearchRun& t : searches)
    if (t.result[kValue] < best[t.scene][t.goal]) best[t.scene][t.goal] = t.result[kValue];
  const AllGaps gaps = gaps_of(searches, times, best);
  add_files(run, searches, plan, gaps, best);

  Report report("Solvers");
  report.paragraph(
      fmt::format("Gap to the best known of ten scenes: for each scene the median over {} seeds, then the median over "
                  "the scenes (in brackets the largest); one core's own time, verification included.",
                  arguments.seeds));
  Json summary;
  for (std::size_t goal = 0; goal < kGoalNames.size(); ++goal)
    summary[kGoalNames[goal]] = show_goal(goal, plan, gaps, report, run);
  summary["times"] = times, summary["seeds"] = arguments.seeds;
  const Json leads = summary[kGoalNames[0]].value("auto_leads", Json());
  report.answer(
      {leads.empty() ? fmt::format("{} solvers on ten scenes.", plan.solvers.size())
                     : fmt::format("For the peak auto leads, or is level, on {} of ten scenes after {:g} s of a core.",
                                   leads.back().get<int>(), times.back()),
       {},
       "The gap of each solver after a time: the figures; of each search: optimizers.csv."},
      run.warnings());
  report.write(run, {"svg"});
  return run.finish(summary, kDone);
}

}  // namespace ukemi::tools

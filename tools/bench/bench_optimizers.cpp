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

constexpr double kNothing = std::numeric_limits<double>::infinity();  ///< the gap of a search that found nothing
constexpr double kLevel = 0.002;                                      ///< two gaps this near are level
constexpr double kDrawn = 1e-5;                                       ///< smaller ones are drawn there

double gap_of(const Trial& t, std::size_t column, const BestKnown& best) {
  return std::isnan(t.found[column]) ? kNothing : t.found[column] / best[t.scene][t.goal] - 1;
}

/// Gaps of one solver for one goal: by budget or mark, then by scene; those of all seeds.
using Gaps = std::vector<std::array<std::vector<double>, kScenes.size()>>;
using GapsOfSolvers = std::map<std::string, Gaps>;
struct AllGaps {
  std::array<GapsOfSolvers, kGoalNames.size()> after_time, after_motions;
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
    const bool known = std::isnan(t.found[kValue]) || !std::isnan(t.found[kAfter + kMarks.size() - 1]);
    if (t.budget == times.back() && known)
      for (std::size_t m = 0; m < kMarks.size(); ++m) by_motions[m][t.scene].push_back(gap_of(t, kAfter + m, best));
  }
  return gaps;
}

/// The gaps of one solver with one budget on one scene, over the seeds; nothing found: infinite.
struct Range {
  std::string scene, goal, solver;
  double budget;
  std::size_t seeds;
  double middle, least, largest;
};
const Quantities<Range> kRangeQuantities = {{"scene", "", &Range::scene},   {"objective", "", &Range::goal},
                                            {"solver", "", &Range::solver}, {"budget_s", "", &Range::budget},
                                            {"seeds", "", &Range::seeds},   {"median", "", &Range::middle},
                                            {"least", "", &Range::least},   {"largest", "", &Range::largest}};
Range range_of(const std::vector<double>& seeds, Range of = {}) {
  const auto [low, high] = std::minmax_element(seeds.begin(), seeds.end());
  of.seeds = seeds.size(), of.middle = median(seeds), of.least = *low, of.largest = *high;
  return of;
}

Quantities<Trial> trial_quantities(const BestKnown& best) {
  Quantities<Trial> out = {{"scene", "", [](auto& t) { return kScenes[t.scene]; }},
                           {"objective", "", [](auto& t) { return kGoalNames[t.goal]; }},
                           {"solver", "", &Trial::solver},
                           {"seed", "", [](auto& t) { return std::to_string(t.seed); }},
                           {"budget_s", "", &Trial::budget},
                           {"gap", "", [&best](auto& t) { return gap_of(t, kValue, best); }}};
  for (std::size_t k = 0; k < kFound; ++k) out.push_back({kColumns[k], "", [k](auto& t) { return t.found[k]; }});
  return out;
}

/// optimizers.csv: every search; gaps.csv: median and range over the seeds; best_known.csv.
void add_files(Run& run, const std::vector<Trial>& trials, const Cases& cases, const AllGaps& gaps,
               const BestKnown& best) {
  run.add("optimizers.csv", Table(trial_quantities(best), trials).csv(run));
  std::vector<Range> ranges;
  for (std::size_t scene = 0; scene < kScenes.size(); ++scene)
    for (std::size_t goal = 0; goal < kGoalNames.size(); ++goal)
      for (const std::string& solver : cases.solvers)
        for (std::size_t k = 0; k < cases.times.size(); ++k)
          ranges.push_back(range_of(gaps.after_time[goal].at(solver)[k][scene],
                                    {kScenes[scene], kGoalNames[goal], solver, cases.times[k]}));
  run.add("gaps.csv", Table(kRangeQuantities, ranges)
                          .csv(run, "The gap to the best known over the seeds of each search; nothing found: empty."));
  CsvWriter known = run.csv();
  known.header({"scene", "peak", "tolerant"});
  for (std::size_t i = 0; i < kScenes.size(); ++i) known.cell(kScenes[i]).cell(best[i][0]).cell(best[i][1]).end_row();
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
      const bool complete = of_scenes.size() == kScenes.size();
      const double middle = complete ? median(of_scenes) : kNothing;
      json[solver].push_back(number(middle));
      rows.back().push_back(complete ? fmt::format("{} ({})", percent(middle, 2),
                                                   percent(*std::max_element(of_scenes.begin(), of_scenes.end()), 0))
                                     : "");
      if (std::isfinite(middle))
        curves.back().x.push_back(x[k]), curves.back().y.push_back(100 * std::max(kDrawn, middle));
    }
  }
  report.table(header, rows);
  report.plot(name, x_label, "gap to the best known [%]", curves, Axes::kLogarithmic);
  run.say("  " + fmt::format("{}", fmt::join(header, "  ")));
  for (const auto& row : rows) run.say(fmt::format("  {}", fmt::join(row, "  ")));
  return json;
}

/// What is searched: what is asked for, else every solver that suits, for these times.
Cases cases_of(const BenchArguments& arguments, std::uint64_t seed) {
  Cases cases{arguments.solvers, arguments.times, seed, arguments.seeds};
  if (cases.solvers.empty()) {
    cases.solvers = landing::solver_names();
    std::erase(cases.solvers, "cma");  // it is for more variables than these scenes have
  }
  for (const std::string& s : cases.solvers) landing::check_solver(s);
  std::vector<double>& times = cases.times;
  if (times.empty()) times = {0.03, 0.1, 0.3, 1};
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return cases;
}

/// The gaps of one goal, after a time and after so many motions.
Json show_goal(std::size_t goal, const Cases& cases, const AllGaps& gaps, Report& report, Run& run) {
  report.heading(kGoalNames[goal]), run.say(fmt::format("{}:", kGoalNames[goal]));
  Json of_goal;
  of_goal["gaps"] = show(report, run, fmt::format("{}_time", kGoalNames[goal]), cases.solvers, gaps.after_time[goal],
                         cases.times, "s", "time of one core [s]");
  if (gaps.after_time[goal].count("auto")) {
    of_goal["auto_leads"] = beside_others(report, gaps.after_time[goal], cases.times);
    const std::string leads = fmt::format("of ten scenes auto leads, or is level, on {}",
                                          fmt::join(of_goal["auto_leads"].get<std::vector<int>>(), ", "));
    report.paragraph(leads), run.say("  " + leads);
  }
  report.paragraph(
      "The same against motions evaluated, from the searches of the longest budget, at the accuracy of the search. "
      "NLopt's solvers evaluate one motion at a time.");
  of_goal["gaps_after"] = show(report, run, fmt::format("{}_motions", kGoalNames[goal]), cases.solvers,
                               gaps.after_motions[goal], kMarks, "motions", "motions evaluated");
  return of_goal;
}

}  // namespace

int bench_optimizers(const BenchArguments& arguments, const CommonOptions& common) {
  Run run(Outputs{"bench optimizers",
                  {"optimizers.csv", "gaps.csv", "best_known.csv"},
                  {"peak_time", "peak_motions", "tolerant_time", "tolerant_motions"}},
          common);
  const Cases cases = cases_of(arguments, common.seed);
  const std::vector<double>& times = cases.times;
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
  for (std::size_t goal = 0; goal < kGoalNames.size(); ++goal)
    summary[kGoalNames[goal]] = show_goal(goal, cases, gaps, report, run);
  summary["times"] = times, summary["seeds"] = arguments.seeds;
  const Json leads = summary[kGoalNames[0]].value("auto_leads", Json());
  report.answer(
      {leads.empty() ? fmt::format("{} solvers on ten scenes.", cases.solvers.size())
                     : fmt::format("For the peak auto leads, or is level, on {} of ten scenes after {:g} s of a core.",
                                   leads.back().get<int>(), times.back()),
       {},
       "The gap of each solver after a time: the figures; of each search: optimizers.csv."},
      run.warnings());
  report.write(run, {"svg"});
  return run.finish(summary, kDone);
}

}  // namespace ukemi::tools

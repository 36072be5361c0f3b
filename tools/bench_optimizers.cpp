// ukemi bench optimizers: every solver on ten scenes and both goals, the gap to the best known against time and
// against motions evaluated.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>

#include "common/actuator.hpp"
#include "common/error.hpp"
#include "common/median.hpp"
#include "common/parallel.hpp"
#include "landing/optimize.hpp"
#include "landing/scene_file.hpp"
#include "landing/solvers.hpp"
#include "tools/bench.hpp"
#include "tools/report.hpp"
#include "tools/verbs.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

constexpr std::array<const char*, 10> kScenes = {"paper", "paper_rough_a", "paper_rough_b", "paper_soft", "low",
                                                 "high",  "straight",      "fast",          "tilted",     "hard"};
constexpr std::array<const char*, 2> kGoals = {"peak", "tolerant"};
constexpr std::array<long, 5> kMarks = {100, 300, 1'000, 5'000, 20'000};
constexpr double kNothing = 1e3;  ///< the gap of a search that found nothing
constexpr double kLevel = 0.002;  ///< two gaps this near are level

/// One search by one solver on one core.
struct Trial {
  std::size_t scene, goal, solver, seed, time;
  Optimum result;
};

/// The best of a search once it had evaluated so many motions, at the search's own accuracy.
double best_after(const Optimum& r, long motions) {
  double best = kNoMotion;
  for (const Progress& p : r.progress)
    if (p.motions <= motions) best = p.best.value;
  return best;
}

/// The best that any search has found, ours or an earlier one's: [scene][goal], datasets/best_known.csv.
using BestKnown = std::array<std::array<double, 2>, kScenes.size()>;
BestKnown best_known(const std::string& path) {
  const CsvTable table = read_csv(path, [](const std::string& name) { return name != "scene"; });
  if (table.rows() != kScenes.size()) throw InputError(path + ": a row for each of the ten scenes is needed");
  BestKnown best;
  for (std::size_t i = 0; i < kScenes.size(); ++i)
    for (std::size_t g = 0; g < 2; ++g) best[i][g] = table.columns[std::size_t(table.find(kGoals[g]))][i];
  return best;
}

}  // namespace

int bench_optimizers(const BenchArguments& arguments, const CommonOptions& common) {
  Run run("bench optimizers", common);
  const Actuator actuator = read_actuator(dataset("actuators/table2.toml"));
  std::vector<Scene> scenes;
  for (const char* name : kScenes) scenes.push_back(read_scene(dataset(fmt::format("scenes/{}.toml", name))));
  const std::vector<std::string> solvers = arguments.solvers.empty() ? solver_names() : arguments.solvers;
  for (const std::string& s : solvers) check_solver(s);
  std::vector<double> times = arguments.times;
  if (times.empty()) times = {0.03, 0.1, 0.3, 1};
  auto best = best_known(dataset("best_known.csv"));

  std::vector<Trial> trials;
  for (std::size_t scene = 0; scene < scenes.size(); ++scene)
    for (std::size_t goal = 0; goal < kGoals.size(); ++goal)
      for (std::size_t solver = 0; solver < solvers.size(); ++solver)
        for (std::size_t seed = 0; seed < std::size_t(arguments.seeds); ++seed)
          for (std::size_t time = 0; time < times.size(); ++time)
            trials.push_back({scene, goal, solver, seed, time, {}});
  double total = 0;
  for (const double t : times) total += t;
  run.info(fmt::format("{} searches, about {:.0f} s on one core", trials.size(),
                       total * double(trials.size()) / double(times.size())));
  std::mutex mutex;
  long done = 0;
  parallel_for(int(trials.size()), common.threads, [&](int i) {
    Trial& t = trials[std::size_t(i)];
    OptimizeOptions o;
    o.solver = solvers[t.solver], o.goal = Goal(int(t.goal)), o.deadline = times[t.time], o.threads = 1;
    o.time = Stopwatch::Time::kProcessor;
    o.seed = common.seed + t.seed, o.tolerance_samples = 0;
    t.result = optimize(scenes[t.scene], actuator.sea, o);
    const std::lock_guard lock(mutex);
    run.progress("searches", ++done, long(trials.size()));
  });

  for (const Trial& t : trials) {
    double& known = best[t.scene][t.goal];
    known = std::min(known, t.result.value);
  }
  const auto to_gap = [&](const Trial& t, double value) {
    return value < kNoMotion ? value / best[t.scene][t.goal] - 1 : kNothing;
  };
  const auto gap = [&](const Trial& t) { return to_gap(t, t.result.found ? t.result.value : kNoMotion); };
  CsvWriter csv = run.csv(), known = run.csv(), by_evaluations = run.csv();
  by_evaluations.comment("From the searches of the longest budget, at the accuracy of the search.");
  by_evaluations.header({"scene", "objective", "solver", "seed", "evaluations", "gap"});
  std::map<std::array<std::size_t, 3>, std::vector<double>> after;  // goal, solver, mark
  csv.header({"scene", "objective", "solver", "seed", "budget_s", "time_s", "evaluations", "landings", "value", "gap",
              "phi_i_deg", "phi_f_deg", "duration"});
  std::map<std::array<std::size_t, 4>, std::vector<double>> gaps;  // goal, solver, time, scene
  for (const Trial& t : trials) {
    const Optimum& r = t.result;
    csv.cell(kScenes[t.scene]).cell(kGoals[t.goal]).cell(solvers[t.solver]).cell(long(common.seed + t.seed));
    csv.cell(times[t.time]).cell(r.seconds).cell(r.evaluations).cell(r.landings).cell(r.value).cell(gap(t));
    csv.cell(r.motion.phi_i * kDegrees).cell(r.motion.phi_f * kDegrees).cell(r.motion.duration).end_row();
    gaps[{t.goal, t.solver, t.time, t.scene}].push_back(gap(t));
    if (t.time + 1 != times.size()) continue;
    for (std::size_t mark = 0; mark < kMarks.size(); ++mark) {
      const double g = to_gap(t, best_after(t.result, kMarks[mark]));
      by_evaluations.cell(kScenes[t.scene]).cell(kGoals[t.goal]).cell(solvers[t.solver]);
      by_evaluations.cell(long(common.seed + t.seed)).cell(kMarks[mark]).cell(g).end_row();
      after[{t.goal, t.solver, mark}].push_back(g);
    }
  }
  known.header({"scene", "peak", "tolerant"});
  for (std::size_t i = 0; i < kScenes.size(); ++i) known.cell(kScenes[i]).cell(best[i][0]).cell(best[i][1]).end_row();
  run.add("optimizers.csv", csv.text());
  run.add("evaluations.csv", by_evaluations.text());
  run.add("best_known.csv", known.text());

  Report report("Solvers");
  report.paragraph(fmt::format(
      "Gap to the best known of ten scenes: for each scene the median over {} seeds, then the median over the scenes "
      "(in brackets the largest); one core's own time, verification included.",
      arguments.seeds));
  Json summary;
  for (std::size_t goal = 0; goal < kGoals.size(); ++goal) {
    report.heading(kGoals[goal]);
    std::vector<std::string> header = {"solver"};
    for (const double t : times) header.push_back(fmt::format("{:g} s", t));
    std::vector<std::vector<std::string>> rows;
    std::vector<Series> curves;
    Json table;
    std::vector<std::vector<std::vector<double>>> medians(solvers.size());  // solver, time, scene
    for (std::size_t solver = 0; solver < solvers.size(); ++solver) {
      std::vector<std::string> row = {solvers[solver]};
      Series curve{solvers[solver], {}, {}};
      for (std::size_t time = 0; time < times.size(); ++time) {
        std::vector<double> of_scenes;
        for (std::size_t scene = 0; scene < scenes.size(); ++scene)
          of_scenes.push_back(median(gaps.at({goal, solver, time, scene})));
        medians[solver].push_back(of_scenes);
        const double middle = median(of_scenes), worst = *std::max_element(of_scenes.begin(), of_scenes.end());
        row.push_back(fmt::format("{:.2f} % ({:.0f} %)", 100 * middle, 100 * worst));
        curve.x.push_back(times[time]), curve.y.push_back(std::max(1e-5, middle));
        table[solvers[solver]].push_back(middle);
      }
      rows.push_back(row), curves.push_back(curve);
    }
    std::vector<std::string> lead = {"scenes where auto leads"};
    for (std::size_t time = 0; time < times.size(); ++time) {
      int ahead = 0;
      const auto self = std::find(solvers.begin(), solvers.end(), "auto") - solvers.begin();
      if (std::size_t(self) == solvers.size()) break;
      for (std::size_t scene = 0; scene < scenes.size(); ++scene) {
        double others = 1e3;
        for (std::size_t s = 0; s < solvers.size(); ++s)
          if (s != std::size_t(self)) others = std::min(others, medians[s][time][scene]);
        ahead += medians[std::size_t(self)][time][scene] <= others + kLevel;
      }
      lead.push_back(fmt::format("{} of {}", ahead, scenes.size()));
      summary[kGoals[goal]]["auto_leads"].push_back(ahead);
    }
    rows.push_back(lead);
    report.table(header, rows);
    report.plot("time [s]", "gap to the best known", curves, Report::Axes::kLogarithmic);
    summary[kGoals[goal]]["gaps"] = table;
    run.say(fmt::format("{}:", kGoals[goal]));
    for (const auto& row : rows) run.say(fmt::format("  {}", fmt::join(row, "  ")));
    header = {"solver"}, rows.clear(), curves.clear();
    for (const long mark : kMarks) header.push_back(fmt::format("{} motions", mark));
    for (std::size_t solver = 0; solver < solvers.size(); ++solver) {
      rows.push_back({solvers[solver]});
      curves.push_back({solvers[solver], {}, {}});
      for (std::size_t mark = 0; mark < kMarks.size(); ++mark) {
        const double middle = median(after.at({goal, solver, mark}));
        rows.back().push_back(fmt::format("{:.2f} %", 100 * middle));
        curves.back().x.push_back(double(kMarks[mark])), curves.back().y.push_back(std::max(1e-5, middle));
        summary[kGoals[goal]]["gaps_after"][solvers[solver]].push_back(middle);
      }
    }
    report.paragraph(
        "The same against motions evaluated, from the searches of the longest budget: medians over scenes and seeds, "
        "at "
        "the accuracy of the search. NLopt's solvers ask for one motion at a time.");
    report.table(header, rows);
    report.plot("motions", "gap to the best known", curves, Report::Axes::kLogarithmic);
  }
  summary["times"] = times, summary["seeds"] = arguments.seeds;
  run.add("report.html", report.html(run.provenance()));
  return run.finish(summary, kDone);
}

}  // namespace ukemi::tools

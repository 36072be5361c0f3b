#include "tools/bench/bench_searches.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <mutex>
#include <span>

#include "common/actuator.hpp"
#include "common/error.hpp"
#include "common/parallel.hpp"
#include "common/stopwatch.hpp"
#include "landing/model/scene_file.hpp"
#include "landing/search/optimize.hpp"
#include "tools/program/arguments.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

/// What one core finds within the budget, of its own time.
std::array<double, kFound> search(const Trial& t, const Scene& scene, const SeaParameters<double>& sea) {
  OptimizeOptions o;
  o.solver = t.solver, o.goal = Goal(int(t.goal)), o.deadline = t.budget, o.seed = t.seed;
  o.threads = 1, o.time = Stopwatch::Time::kProcessor, o.tolerance_samples = 0;
  const Optimum r = optimize(scene, sea, o);
  std::array<double, kFound> found;
  found.fill(std::numeric_limits<double>::quiet_NaN());
  found[kTime] = r.seconds, found[kEvaluations] = double(r.evaluations), found[kLandings] = double(r.landings);
  for (const Progress& p : r.progress)
    for (std::size_t m = 0; m < kMarks.size(); ++m)
      if (double(p.motions) <= kMarks[m] && p.value < kNoMotion) found[kAfter + m] = p.value;
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

}  // namespace

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
            one_of(kGoalNames, table.texts[goal][i], table.at(int(goal), i)),
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

BestKnown best_known(const std::string& path) {
  const CsvTable table = read_csv(path, [](const std::string&) { return true; }, NanCells::kRefused, {"scene"});
  if (table.rows() != kScenes.size()) throw InputError(path + ": a row for each of the ten scenes is needed");
  const std::size_t scene = column(table, "scene");
  for (const char* goal : kGoalNames) table.require_full(table.require(goal));
  BestKnown best{};
  std::array<bool, kScenes.size()> known{};
  for (std::size_t i = 0; i < table.rows(); ++i) {
    const Location where = table.at(int(scene), i);
    const std::size_t s = one_of(kScenes, table.texts[scene][i], where);
    if (std::exchange(known[s], true)) throw InputError(where, quoted(kScenes[s]) + ": the scene is given twice");
    for (std::size_t g = 0; g < kGoalNames.size(); ++g) best[s][g] = table.columns[column(table, kGoalNames[g])][i];
  }
  return best;
}

std::vector<Trial> searched(const Cases& cases, std::vector<Trial> earlier, const Run& run) {
  std::stable_sort(earlier.begin(), earlier.end());
  std::vector<Trial> trials;
  std::vector<std::size_t> open;
  double seconds = 0;
  for (std::size_t scene = 0; scene < kScenes.size(); ++scene)
    for (std::size_t goal = 0; goal < kGoalNames.size(); ++goal)
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
    run.progress("bench", "searches", ++done, long(open.size()));
  });
  return trials;
}

}  // namespace ukemi::tools

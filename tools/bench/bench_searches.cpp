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

/// The result of one search within its budget of processor time.
std::array<double, kResults> search(const SearchRun& t, const Scene& scene, const SeaParameters<double>& sea) {
  OptimizeOptions o;
  o.solver = t.solver, o.goal = Goal(int(t.goal)), o.deadline = t.budget, o.seed = t.seed;
  o.threads = 1, o.time = Stopwatch::Time::kProcessor, o.tolerance_samples = 0;
  const Optimum r = optimize(scene, sea, o);
  std::array<double, kResults> out;
  out.fill(std::numeric_limits<double>::quiet_NaN());
  out[kTime] = r.seconds, out[kEvaluations] = double(r.evaluations), out[kLandings] = double(r.landings);
  for (const Progress& p : r.progress)
    for (std::size_t m = 0; m < kMotions.size(); ++m)
      if (double(p.motions) <= kMotions[m] && p.value < kNoMotion) out[kAfter + m] = p.value;
  if (!r.found) return out;
  out[kValue] = r.value, out[kDuration] = r.motion.duration;
  out[kPhiI] = r.motion.phi_i * kDegrees, out[kPhiF] = r.motion.phi_f * kDegrees;
  return out;
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

std::vector<SearchRun> read_searches(const std::string& path) {
  const CsvTable table = read_csv(path, {}, NanCells::kRefused, {"scene", "objective", "solver", "seed"});
  const std::size_t scene = column(table, "scene"), goal = column(table, "objective"), solver = column(table, "solver"),
                    seed = column(table, "seed"), budget = column(table, "budget_s");
  column(table, kColumns[kValue]);
  table.require_full(int(budget));
  std::vector<SearchRun> searches;
  for (std::size_t i = 0; i < table.rows(); ++i) {
    SearchRun t{one_of(kScenes, table.texts[scene][i], table.at(int(scene), i)),
                one_of(kGoalNames, table.texts[goal][i], table.at(int(goal), i)),
                table.texts[solver][i],
                seed_at(table, seed, i),
                table.columns[budget][i],
                {}};
    for (std::size_t k = 0; k < kResults; ++k) {
      const int c = table.find(kColumns[k]);
      t.result[k] = c < 0 ? std::numeric_limits<double>::quiet_NaN() : table.columns[std::size_t(c)][i];
    }
    searches.push_back(t);
  }
  return searches;
}

BestKnown best_known(const std::string& path) {
  const CsvTable table = read_csv(path, {}, NanCells::kRefused, {"scene"});
  if (table.rows() != kScenes.size()) throw InputError(path + ": a row for each of the ten scenes is needed");
  const std::size_t scene = column(table, "scene");
  for (const char* goal : kGoalNames) table.require_full(table.require(goal));
  BestKnown best{};
  std::array<bool, kScenes.size()> given{};
  for (std::size_t i = 0; i < table.rows(); ++i) {
    const Location where = table.at(int(scene), i);
    const std::size_t s = one_of(kScenes, table.texts[scene][i], where);
    if (std::exchange(given[s], true)) throw InputError(where, quoted(kScenes[s]) + ": the scene is given twice");
    for (std::size_t g = 0; g < kGoalNames.size(); ++g) best[s][g] = table.columns[column(table, kGoalNames[g])][i];
  }
  return best;
}

std::vector<SearchRun> run_searches(const SearchPlan& plan, std::vector<SearchRun> earlier, const Run& run) {
  std::stable_sort(earlier.begin(), earlier.end());
  std::vector<SearchRun> searches;
  std::vector<std::size_t> pending;
  double seconds = 0;
  for (std::size_t scene = 0; scene < kScenes.size(); ++scene)
    for (std::size_t goal = 0; goal < kGoalNames.size(); ++goal)
      for (const std::string& solver : plan.solvers)
        for (int s = 0; s < plan.seeds; ++s)
          for (const double t : plan.times) {
            searches.push_back({scene, goal, solver, plan.first_seed + std::uint64_t(s), t, {}});
            const auto same = std::lower_bound(earlier.begin(), earlier.end(), searches.back());
            if (same != earlier.end() && same->key() == searches.back().key())
              searches.back() = *same;
            else
              pending.push_back(searches.size() - 1), seconds += t;
          }
  run.info(fmt::format("{} searches, {} from earlier runs; about {:.0f} s on one core", searches.size(),
                       searches.size() - pending.size(), seconds));
  const Actuator actuator = read_actuator(dataset("actuators/table2.toml"));
  std::vector<Scene> scenes;
  for (const char* name : kScenes) scenes.push_back(read_scene(dataset(fmt::format("scenes/{}.toml", name))));
  std::mutex mutex;
  long done = 0;
  parallel_for(int(pending.size()), run.options().threads, [&](int i) {
    SearchRun& t = searches[pending[std::size_t(i)]];
    t.result = search(t, scenes[t.scene], actuator.sea);
    const std::lock_guard lock(mutex);
    run.progress("bench", "searches", ++done, long(pending.size()));
  });
  return searches;
}

}  // namespace ukemi::tools

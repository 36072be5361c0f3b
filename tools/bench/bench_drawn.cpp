// ukemi bench drawn: the search on scenes drawn from a seed, which no tuning has seen.
//
// The settings of auto were tuned on the shipped scenes; how well a search works where nobody looked, only scenes that
// nobody chose can say. A scene's best known value is the lowest of all searches of this run, among them long ones of
// three kinds.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

#include "common/actuator.hpp"
#include "common/median.hpp"
#include "common/parallel.hpp"
#include "landing/judge/answer.hpp"
#include "landing/model/scene_file.hpp"
#include "tools/bench/bench_searches.hpp"
#include "tools/bench/stability.hpp"
#include "tools/report/table.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

constexpr std::array<const char*, 3> kLong = {"auto", "de", "crs2"};
constexpr double kLonger = 5;  ///< times the longest budget, for the searches that say what is best

/// One search on a drawn scene.
struct DrawnSearch {
  std::size_t scene, goal;
  std::string solver;
  std::uint64_t seed;
  double budget;                                           ///< [s]
  double value = std::numeric_limits<double>::infinity();  ///< nothing found: infinite
  double gap = std::numeric_limits<double>::quiet_NaN();   ///< to the scene's best known
};

/// Drawn scenes where the robot falls onto the floor and the held reference can be followed.
std::vector<StabilityCase> draw(int scenes, std::uint64_t seed, int bumps) {
  const Scene paper = read_scene(dataset("scenes/paper.toml"));
  const SeaParameters<double> table2 = read_actuator(dataset("actuators/table2.toml")).sea;
  std::vector<StabilityCase> out;
  for (std::uint64_t i = 0; int(out.size()) < scenes; ++i) {
    StabilityCase c = random_landing(paper, table2, seed, i);
    c.scene.freedom.bumps = bumps;
    const LandingPeak held = peak_acceleration(c.scene, c.sea, kHeld);
    if (c.scene.touches() && !no_landing(held.end)) out.push_back(std::move(c));
  }
  return out;
}

/// The gaps of one goal and budget, over all scenes: of each the median over its seeds.
struct DrawnGap {
  std::string goal;
  double budget, middle, worst;
};

}  // namespace

int bench_drawn(const BenchArguments& a, const CommonOptions& common) {
  Run run("bench drawn", common);
  std::vector<double> times = a.times.empty() ? std::vector<double>{0.1, 1} : a.times;
  std::sort(times.begin(), times.end());
  const std::vector<StabilityCase> scenes = draw(a.drawn, common.seed, a.bumps);
  std::vector<DrawnSearch> searches;
  for (std::size_t i = 0; i < scenes.size(); ++i)
    for (std::size_t g = 0; g < kGoalNames.size(); ++g) {
      for (int s = 0; s < a.seeds; ++s)
        for (const double t : times) searches.push_back({i, g, "auto", common.seed + std::uint64_t(s), t});
      for (const char* solver : kLong) searches.push_back({i, g, solver, common.seed + 1000, kLonger * times.back()});
    }
  std::mutex mutex;
  long done = 0;
  parallel_for(int(searches.size()), common.threads, [&](int i) {
    DrawnSearch& s = searches[std::size_t(i)];
    const StabilityCase& c = scenes[s.scene];
    const Optimum best = search_on_a_core(c.scene, c.sea, s.solver, Goal(int(s.goal)), s.budget, s.seed, a.settings);
    if (best.found) s.value = best.value;
    const std::lock_guard lock(mutex);
    run.progress("searches", ++done, long(searches.size()));
  });
  for (DrawnSearch& s : searches) {
    double best = std::numeric_limits<double>::infinity();
    for (const DrawnSearch& o : searches)
      if (o.scene == s.scene && o.goal == s.goal) best = std::min(best, o.value);
    s.gap = s.value / best - 1;
  }
  std::vector<DrawnGap> gaps;
  for (std::size_t g = 0; g < kGoalNames.size(); ++g)
    for (const double t : times) {
      std::vector<double> of_scenes;
      for (std::size_t i = 0; i < scenes.size(); ++i) {
        std::vector<double> of_seeds;
        for (const DrawnSearch& s : searches)
          if (s.scene == i && s.goal == g && s.budget == t && s.solver == "auto") of_seeds.push_back(s.gap);
        of_scenes.push_back(median(of_seeds));
      }
      gaps.push_back({kGoalNames[g], t, median(of_scenes), *std::max_element(of_scenes.begin(), of_scenes.end())});
    }
  const Quantities<DrawnGap> gap_quantities = {{"objective", &DrawnGap::goal},
                                               {"budget_s", &DrawnGap::budget},
                                               {"median", &DrawnGap::middle},
                                               {"worst", &DrawnGap::worst}};
  const Quantities<DrawnSearch> search_quantities = {{"scene", [](auto& s) { return s.scene; }},
                                                     {"objective", [](auto& s) { return kGoalNames[s.goal]; }},
                                                     {"solver", &DrawnSearch::solver},
                                                     {"seed", [](auto& s) { return std::to_string(s.seed); }},
                                                     {"budget_s", &DrawnSearch::budget},
                                                     {"value", &DrawnSearch::value},
                                                     {"gap", &DrawnSearch::gap}};
  for (const DrawnGap& g : gaps)
    run.say(fmt::format(
        "{:8} {:g} s: gap to the best known over {} drawn scenes, {} seeds: median {:.2f} %, worst {:.2f} %", g.goal,
        g.budget, scenes.size(), a.seeds, 100 * g.middle, 100 * g.worst));
  run.add("drawn.csv", Table(search_quantities, searches).csv(run));
  return run.finish({{"scenes", scenes.size()}, {"seeds", a.seeds}, {"gaps", Table(gap_quantities, gaps).objects()}},
                    kDone);
}

}  // namespace ukemi::tools

// The search on scenes drawn from a seed, which no tuning has seen: bench_drawn PAPER.toml TABLE2.toml [SCENES [SEEDS
// [SEED [BUMPS]]]]. A scene's best known value is the lowest of all searches of the run, among them long ones of three
// kinds; printed are the gaps to it: of each scene the median over the seeds, of those the median and the worst.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "common/actuator.hpp"
#include "common/median.hpp"
#include "common/parallel.hpp"
#include "common/stopwatch.hpp"
#include "landing/model/scene_file.hpp"
#include "landing/search/optimize.hpp"
#include "test/three_ways.hpp"

using namespace ukemi;
using namespace ukemi::landing;

namespace {

constexpr double kTimes[] = {0.1, 1};  ///< of one core [s]
constexpr double kLong = 5;            ///< the same, of the searches that say what is best
constexpr const char* kLongSolvers[] = {"auto", "de", "crs2"};

struct Task {
  std::size_t scene;
  Goal goal;
  std::string solver;
  std::uint64_t seed;
  double seconds, value = kNoMotion;
};

/// Drawn scenes where the robot falls onto the floor and the held reference can be followed.
std::vector<StabilityCase> draw(const Scene& paper, const SeaParameters<double>& table2, int scenes, std::uint64_t seed,
                                int bumps) {
  std::vector<StabilityCase> out;
  for (std::uint64_t i = 0; int(out.size()) < scenes; ++i) {
    StabilityCase c = random_landing(paper, table2, seed, i);
    c.scene.freedom.bumps = bumps;
    const LandingPeak held = peak_acceleration(c.scene, c.sea, kHeld);
    if (c.scene.touches() && !no_landing(held.end)) out.push_back(std::move(c));
  }
  return out;
}

}  // namespace

int main(int count, char** given) {
  if (count < 3) return fmt::print(stderr, "bench_drawn PAPER.toml TABLE2.toml [SCENES [SEEDS [SEED [BUMPS]]]]\n"), 2;
  const auto number = [&](int i, int otherwise) { return count > i ? std::atoi(given[i]) : otherwise; };
  const int seeds = number(4, 5);
  const std::uint64_t seed = std::uint64_t(number(5, 7));
  const auto scenes = draw(read_scene(given[1]), read_actuator(given[2]).sea, number(3, 12), seed, number(6, 0));
  std::vector<Task> tasks;
  for (std::size_t i = 0; i < scenes.size(); ++i)
    for (const Goal goal : {Goal::kPeak, Goal::kTolerant}) {
      for (int s = 0; s < seeds; ++s)
        for (const double t : kTimes) tasks.push_back({i, goal, "auto", seed + std::uint64_t(s), t});
      for (const char* solver : kLongSolvers) tasks.push_back({i, goal, solver, seed + 1000, kLong});
    }
  parallel_for(int(tasks.size()), 0, [&](int i) {
    Task& t = tasks[std::size_t(i)];
    OptimizeOptions o;
    o.solver = t.solver, o.goal = t.goal, o.deadline = t.seconds, o.seed = t.seed;
    o.threads = 1, o.time = Stopwatch::Time::kProcessor, o.tolerance_samples = 0;
    const Optimum best = optimize(scenes[t.scene].scene, scenes[t.scene].sea, o);
    if (best.found) t.value = best.value;
  });
  fmt::print("objective,seconds,median_gap,worst_gap\n");
  for (const Goal goal : {Goal::kPeak, Goal::kTolerant})
    for (const double t : kTimes) {
      std::vector<double> gaps;
      for (std::size_t i = 0; i < scenes.size(); ++i) {
        double best = kNoMotion;
        std::vector<double> values;
        for (const Task& k : tasks) {
          if (k.scene != i || k.goal != goal) continue;
          best = std::min(best, k.value);
          if (k.solver == "auto" && k.seconds == t) values.push_back(k.value);
        }
        gaps.push_back(median(values) / best - 1);
      }
      fmt::print("{},{},{:.4f},{:.4f}\n", goal == Goal::kPeak ? "peak" : "tolerant", t, median(gaps),
                 *std::max_element(gaps.begin(), gaps.end()));
    }
}

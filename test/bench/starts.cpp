// Where a search begins, and by what it descends: bench_starts PAPER.toml TABLE2.toml [SCENES [SEEDS [SEED [BUMPS]]]].
// Searches on scenes drawn from a seed, which no tuning has seen, at several times: cold; from the plans of four
// neighbours of the scene, as an atlas that was built while idle has them, as angles and as what the foot meets; by
// SQP with exact gradients from the best of many races in lanes, beside cold differential evolution. A scene's best
// known value is the lowest of all of the run; printed are the median and the worst gap to it, of the median over the
// seeds.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "common/actuator.hpp"
#include "common/degrees.hpp"
#include "common/median.hpp"
#include "common/parallel.hpp"
#include "common/stopwatch.hpp"
#include "landing/judge/under_scatter.hpp"
#include "landing/model/motion_space.hpp"
#include "landing/model/scene_file.hpp"
#include "landing/search/optimize.hpp"
#include "test/three_ways.hpp"

using namespace ukemi;
using namespace ukemi::landing;

namespace {

constexpr double kTimes[] = {0.1, 0.3, 1, 3, 10};         ///< of one core [s]
constexpr double kOften = 1;                              ///< up to this time with each seed, else with the first [s]
constexpr double kIdle = 3;                               ///< for the plan of each neighbour [s]
constexpr double kHigher = 0.05, kSteeper = 2 * kDegree;  ///< the neighbours: of the height, of the pitch

struct Way {
  const char* name;
  const char* solver;
  enum { kCold, kAngles, kFoot, kBoth } starts;
};
constexpr Way kWays[] = {{"cold", "auto", Way::kCold},          {"neighbours", "auto", Way::kAngles},
                         {"by the foot", "auto", Way::kFoot},   {"both", "auto", Way::kBoth},
                         {"sqp from races", "sqp", Way::kCold}, {"de", "de", Way::kCold}};

struct Task {
  std::size_t scene;
  Goal goal;
  std::size_t way;
  std::uint64_t seed;
  double seconds, value = kNoMotion;
};

OptimizeOptions options_of(Goal goal, double seconds, std::uint64_t seed) {
  OptimizeOptions o;
  o.goal = goal, o.deadline = seconds, o.seed = seed;
  o.threads = 1, o.time = Stopwatch::Time::kProcessor, o.tolerance_samples = 0;
  return o;
}

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

std::vector<Scene> neighbours(const Scene& scene) {
  std::vector<Scene> out(4, scene);
  out[0].drop.height *= 1 + kHigher, out[1].drop.height *= 1 - kHigher;
  out[2].drop.pitch += kSteeper, out[3].drop.pitch -= kSteeper;
  return out;
}

/// The motion that turns the shank by the same angles to the floor, as quickly for the speed of the fall.
MotionValues by_the_foot(const MotionSpace& space, MotionValues values, const Scene& from, const Scene& to) {
  for (std::size_t k = 0; k < space.variables().size(); ++k) {
    const Variable& v = space.variables()[k];
    double& x = values[long(k)];
    if (v.name.rfind("phi_", 0) == 0) x += from.drop.pitch - to.drop.pitch;
    if (v.name == "duration") x *= std::sqrt(from.drop.height / to.drop.height);
    x = std::clamp(x, v.lower, v.upper);
  }
  return values;
}

}  // namespace

int main(int count, char** given) {
  if (count < 3) return fmt::print(stderr, "bench_starts PAPER.toml TABLE2.toml [SCENES [SEEDS [SEED [BUMPS]]]]\n"), 2;
  const auto number = [&](int i, int otherwise) { return count > i ? std::atoi(given[i]) : otherwise; };
  const int seeds = number(4, 3);
  const std::uint64_t seed = std::uint64_t(number(5, 7));
  const auto scenes = draw(read_scene(given[1]), read_actuator(given[2]).sea, number(3, 8), seed, number(6, 2));
  constexpr Goal kGoals[] = {Goal::kPeak, Goal::kTolerant};
  // starts[scene][goal][neighbour]: as angles, as what the foot meets
  std::vector<std::array<std::array<std::vector<MotionValues>, 2>, 2>> starts(scenes.size());
  parallel_for(int(scenes.size()), 0, [&](int i) {
    const StabilityCase& c = scenes[std::size_t(i)];
    const ReferenceSpace space(c.scene, c.sea);
    for (int g = 0; g < 2; ++g)
      for (const Scene& n : neighbours(c.scene)) {
        const Optimum best = optimize(n, c.sea, options_of(kGoals[g], kIdle, seed + 2000));
        if (!best.found) continue;
        auto& [angles, foot] = starts[std::size_t(i)][std::size_t(g)];
        angles.push_back(best.values), foot.push_back(by_the_foot(space, best.values, n, c.scene));
      }
  });
  std::vector<Task> tasks;
  for (std::size_t i = 0; i < scenes.size(); ++i)
    for (const Goal goal : kGoals)
      for (std::size_t m = 0; m < std::size(kWays); ++m)
        for (const double t : kTimes)
          for (int s = 0; s < (t <= kOften ? seeds : 1); ++s) tasks.push_back({i, goal, m, seed + std::uint64_t(s), t});
  parallel_for(int(tasks.size()), 0, [&](int i) {
    Task& t = tasks[std::size_t(i)];
    const StabilityCase& c = scenes[t.scene];
    OptimizeOptions o = options_of(t.goal, t.seconds, t.seed);
    const Way& m = kWays[t.way];
    o.solver = m.solver;
    const auto& [angles, foot] = starts[t.scene][t.goal == Goal::kTolerant];
    if (m.starts == Way::kAngles || m.starts == Way::kBoth) o.starts = angles;
    if (m.starts == Way::kFoot || m.starts == Way::kBoth) o.starts.insert(o.starts.end(), foot.begin(), foot.end());
    const Optimum best = optimize(c.scene, c.sea, o);
    if (best.found) t.value = best.value;
  });
  fmt::print("objective,method,seconds,median_gap,worst_gap\n");
  for (const Goal goal : kGoals)
    for (std::size_t m = 0; m < std::size(kWays); ++m)
      for (const double t : kTimes) {
        std::vector<double> gaps;
        for (std::size_t i = 0; i < scenes.size(); ++i) {
          double best = kNoMotion;
          std::vector<double> values;
          for (const Task& k : tasks) {
            if (k.scene != i || k.goal != goal) continue;
            best = std::min(best, k.value);
            if (k.way == m && k.seconds == t) values.push_back(k.value);
          }
          gaps.push_back(median(values) / best - 1);
        }
        fmt::print("{},{},{},{:.4f},{:.4f}\n", goal == Goal::kPeak ? "peak" : "tolerant", kWays[m].name, t,
                   median(gaps), *std::max_element(gaps.begin(), gaps.end()));
      }
}

// Landings a second in SIMD lanes against the scalar path, and how late a planner answers: bench_batch PAPER.toml
// TABLE2.toml [CALLS]. 6,000 random motions of the scene, every path in turn, the least of five passes; errors against
// the scalar path at 1e-11.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

#include "common/actuator.hpp"
#include "common/random.hpp"
#include "common/stopwatch.hpp"
#include "landing/lanes/batch.hpp"
#include "landing/model/scene_file.hpp"
#include "landing/search/planner.hpp"

using namespace ukemi;
using namespace ukemi::landing;

namespace {

constexpr int kLandings = 6000, kPasses = 5;

void print_throughput(const Scene& scene, const SeaParameters<double>& sea) {
  std::vector<BatchCase> cases;
  std::vector<double> exact;
  for (int i = 0; i < kLandings; ++i) {
    Random r(1, std::uint64_t(i));
    const auto [phi, duration] = scene.search;
    const Motion motion{r.uniform(phi[0], phi[1]), r.uniform(phi[0], phi[1]), r.uniform(duration[0], duration[1])};
    cases.push_back({&scene, &sea, motion});
    exact.push_back(peak_acceleration(scene, sea, motion, {.accuracy = 1e-11}).peak);
  }
  std::vector<LandingPeak> peaks(cases.size());
  fmt::print("accuracy,path,landings_per_second,times_scalar,off_by_1e4\n");
  for (const double accuracy : {1e-5, 1e-6}) {
    constexpr int kScalar = -1;
    std::vector<double> least(std::size_t(widest_instruction_set()) + 2, std::numeric_limits<double>::infinity());
    std::vector<long> off(least.size());
    for (int pass = 0; pass < kPasses; ++pass)
      for (int path = kScalar; path <= int(widest_instruction_set()); ++path) {
        const std::size_t p = std::size_t(path + 1);
        const Stopwatch watch(Stopwatch::Time::kProcessor);
        if (path == kScalar)
          for (std::size_t i = 0; i < cases.size(); ++i)
            peaks[i] = peak_acceleration(scene, sea, cases[i].motion, {.accuracy = accuracy});
        else
          batch_peaks(cases, peaks, {.accuracy = accuracy}, 1, InstructionSet(path));
        least[p] = std::min(least[p], watch.seconds());
        off[p] = 0;
        for (std::size_t i = 0; i < cases.size(); ++i) off[p] += std::abs(peaks[i].peak / exact[i] - 1) > 1e-4;
      }
    for (std::size_t p = 0; p < least.size(); ++p)
      fmt::print("{:g},{},{:.0f},{:.2f},{}\n", accuracy, p == 0 ? "scalar" : kInstructionSetNames[p - 1],
                 kLandings / least[p], least[0] / least[p], off[p]);
  }
}

void print_lateness(const Scene& scene, const SeaParameters<double>& sea, int calls) {
  fmt::print("objective,deadline,median_late_ms,q999_late_ms,worst_late_ms,found\n");
  for (const Goal goal : {Goal::kPeak, Goal::kTolerant})
    for (const double deadline : {0.05, 0.1}) {
      Planner planner(scene, sea, {.goal = goal});
      std::vector<double> late;
      long found = 0;
      for (int i = 0; i < calls; ++i) {
        Random r(1, std::uint64_t(i));
        Drop drop = scene.drop;
        drop.height += r.uniform(-0.1, 0.1), drop.pitch += r.uniform(-0.1, 0.1);
        drop.forward_speed += r.uniform(-0.2, 0.2);
        const Stopwatch watch(Stopwatch::Time::kWall);
        found += planner.plan(drop, deadline, std::uint64_t(i)).found();
        late.push_back(1e3 * (watch.seconds() - deadline));
      }
      std::sort(late.begin(), late.end());
      const auto at = [&](double q) { return late[std::min(late.size() - 1, std::size_t(q * double(late.size())))]; };
      fmt::print("{},{},{:.2f},{:.2f},{:.2f},{}\n", goal == Goal::kPeak ? "peak" : "tolerant", deadline, at(0.5),
                 at(0.999), at(1), found);
    }
}

}  // namespace

int main(int count, char** given) {
  if (count < 3) return fmt::print(stderr, "bench_batch PAPER.toml TABLE2.toml [CALLS]\n"), 2;
  const Scene scene = read_scene(given[1]);
  const SeaParameters<double> sea = read_actuator(given[2]).sea;
  print_throughput(scene, sea);
  print_lateness(scene, sea, count > 3 ? std::atoi(given[3]) : 1000);
}

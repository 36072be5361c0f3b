// Plans of robots of links on scenes that no tuning has seen: bench_plans SEED VARIANTS SEEDS EVALUATIONS SCENE.toml...
// Each scene with its drop height, pitch and masses drawn from SEED, planned with so many seeds. A variant's best known
// value is the lowest of all of the run, and of 8 longer searches; printed are the gaps to it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <vector>

#include "common/median.hpp"
#include "common/parallel.hpp"
#include "common/random.hpp"
#include "landing/body/body_scene.hpp"
#include "landing/plan/body_plan.hpp"
#include "landing/plan/design_numbers.hpp"

using namespace ukemi;
using namespace ukemi::landing;

namespace {

constexpr int kLonger = 8;        ///< searches for the best known value of a variant
constexpr double kWithin = 0.02;  ///< of the best known value: found

/// Heights by a factor of 2, masses of 1.7, a free base's pitch by 25 deg, either way.
BodyScene variant(BodyScene scene, std::uint64_t seed, std::uint64_t i) {
  Random random(seed, i);
  const auto set = [&](const std::string& name, double value) { set_design_number(scene, name, value); };
  const auto scale = [&](const std::string& name, double factor) {
    set(name, design_number(scene, name) * std::pow(factor, random.uniform(-1, 1)));
  };
  scale("drop.height", 2);
  if (scene.robot.base == Base::kFree)
    set("drop.pitch_deg", design_number(scene, "drop.pitch_deg") + random.uniform(-25, 25));
  for (std::size_t k = 0; k < scene.robot.links.size(); ++k)
    scale("robot.link." + scene.robot.links[k].name + ".mass", 1.7);
  scene.validate();
  return scene;
}

double planned(const BodyScene& scene, long evaluations, std::uint64_t seed) {
  const BodyPlan p = plan(scene, {.evaluations = evaluations, .accuracy = 1e-8, .seed = seed, .threads = 1});
  return p.found ? p.value : kNoMotion;
}

}  // namespace

int main(int count, char** given) {
  if (count < 6) return fmt::print(stderr, "usage: bench_plans SEED VARIANTS SEEDS EVALUATIONS SCENE.toml...\n"), 2;
  const auto seed = std::uint64_t(std::atol(given[1]));
  const int variants = std::atoi(given[2]), seeds = std::atoi(given[3]);
  const long evaluations = std::atol(given[4]);
  fmt::print("scene,evaluations,plans,median_gap,mean_gap,worst_gap,found\n");
  for (int s = 5; s < count; ++s) {
    const BodyScene scene = read_body_scene(given[s]);
    std::vector<std::vector<double>> values(std::size_t(variants), std::vector<double>(std::size_t(seeds + kLonger)));
    parallel_for(variants * (seeds + kLonger), 0, [&](int task) {
      const int i = task / (seeds + kLonger), n = task % (seeds + kLonger);
      values[std::size_t(i)][std::size_t(n)] =
          planned(variant(scene, seed, std::uint64_t(i)), n < seeds ? evaluations : 2 * evaluations,
                  1000 * seed + std::uint64_t(n));
    });
    std::vector<double> gaps;
    for (const std::vector<double>& of : values) {
      const double best = *std::min_element(of.begin(), of.end());
      for (int n = 0; n < seeds; ++n) gaps.push_back(of[std::size_t(n)] / best - 1);
    }
    double sum = 0;
    for (const double g : gaps) sum += g;
    const auto found = std::count_if(gaps.begin(), gaps.end(), [](double g) { return g <= kWithin; });
    fmt::print("{},{},{},{:.3f},{:.3f},{:.3f},{:.2f}\n", std::filesystem::path(given[s]).stem().string(), evaluations,
               gaps.size(), median(gaps), sum / double(gaps.size()), *std::max_element(gaps.begin(), gaps.end()),
               double(found) / double(gaps.size()));
  }
}

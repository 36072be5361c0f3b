// How near an atlas comes to a long search, for drops between those of its grid: bench_atlas ATLAS SCENE ACTUATOR
// [DROPS [SECONDS [SEED]]]. For each random drop within the grid: the atlas's motion, that and 0.1 s of search from it,
// 0.1 s of search from nothing, and the best of all of them and of so many seconds [15] from it.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "common/actuator.hpp"
#include "common/degrees.hpp"
#include "common/random.hpp"
#include "landing/atlas/atlas_file.hpp"
#include "landing/atlas/atlas_reader.hpp"
#include "landing/model/scene_file.hpp"
#include "landing/search/planner.hpp"

using namespace ukemi;
using namespace ukemi::landing;

int main(int count, char** given) {
  const auto number = [&](int i, double otherwise) { return count > i ? std::atof(given[i]) : otherwise; };
  const Scene scene = read_scene(given[2]);
  const Actuator actuator = read_actuator(given[3]);
  AtlasReader reader(given[1], scene, actuator.sea, {.goal = Goal::kPeak});
  const AtlasGrid grid = MappedAtlas(given[1]).header().grid;
  Planner planner(scene, actuator.sea, {.goal = Goal::kPeak});
  Random random(std::uint64_t(number(6, 1)));
  std::vector<double> gaps[4];
  const char* names[] = {"atlas", "0.1 s from all", "0.1 s from the best", "0.1 s"};
  for (int k = 0; k < int(number(4, 20)); ++k) {
    const auto between = [&](const AtlasAxis& a) { return a.lower + random.uniform() * (a.upper - a.lower); };
    const Drop drop{
        .height = between(grid.axes[0]), .forward_speed = between(grid.axes[1]), .pitch = between(grid.axes[2])};
    const AtlasEntry entry = reader.at(drop);
    const auto planned = [&](double seconds, std::size_t starts) {
      planner.start(entry.starts().first(std::min(starts, entry.count)));
      return planner.plan(drop, seconds).value;
    };
    const double values[] = {entry.value, planned(0.1, 8), planned(0.1, 1), planned(0.1, 0)};
    const double best = std::min(*std::min_element(std::begin(values), std::end(values)), planned(number(5, 15), 1));
    fmt::print("height {:.3f} m, speed {:5.2f} m/s, pitch {:5.1f} deg: best {:.2f} m/s^2", drop.height,
               drop.forward_speed, drop.pitch * kDegrees, best);
    for (int i = 0; i < 4; ++i) {
      gaps[i].push_back(100 * (values[i] / best - 1));
      fmt::print("; {} +{:.2f} %", names[i], gaps[i].back());
    }
    fmt::print("\n");
    std::fflush(stdout);
  }
  for (int i = 0; i < 4; ++i) {
    std::sort(gaps[i].begin(), gaps[i].end());
    const auto within = std::count_if(gaps[i].begin(), gaps[i].end(), [](double g) { return g <= 3; });
    fmt::print("{}: median {:.2f} %, worst {:.2f} %, within 3 %: {} of {}\n", names[i], gaps[i][gaps[i].size() / 2],
               gaps[i].back(), within, gaps[i].size());
  }
}

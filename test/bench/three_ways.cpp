// Landings by the thousand, each followed three ways: bench_three_ways [MOTIONS of each shipped scene [SCENES [SEED]]].
// A difference of more than 0.1 % is sensitive where moving the scene by 1e-6 makes one as well, coarse where the lanes
// are right at 1e-7, else wrong: those are listed.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <functional>

#include "common/actuator.hpp"
#include "landing/model/files.hpp"
#include "test/three_ways.hpp"

namespace {

using namespace ukemi;
using namespace ukemi::landing;

/// The scenes of the paper's robot, of datasets/scenes.
constexpr std::array<const char*, 10> kScenes = {"paper", "paper_rough_a", "paper_rough_b", "paper_soft", "low",
                                                 "high",  "straight",      "fast",          "tilted",     "hard"};

using Draw = std::function<StabilityCase(std::uint64_t)>;

/// Follows `count` drawn landings; returns how many are wrong.
long follow(const std::string& group, long count, const Draw& draw) {
  std::array<long, 5> verdicts{};
  double scalar = 0, lanes = 0;
  constexpr long kPart = 1000;
  for (long from = 0; from < count; from += kPart) {
    std::vector<StabilityCase> cases;
    for (long i = from; i < std::min(count, from + kPart); ++i) cases.push_back(draw(std::uint64_t(i)));
    const std::vector<CrossCheck> results = cross_check(cases, 0);
    for (std::size_t i = 0; i < results.size(); ++i) {
      const CrossCheck& c = results[i];
      ++verdicts[std::size_t(c.verdict)];
      if (c.verdict == Verdict::kPass)
        scalar = std::max(scalar, c.scalar_difference), lanes = std::max(lanes, c.lanes_difference);
      if (c.verdict == Verdict::kWrong)
        fmt::print("wrong: {} {}: {}: scalar {}, lanes {}, tight {}\n", group, cases[i].setting, c.reason, c.scalar,
                   c.lanes, c.tight);
    }
  }
  fmt::print("{:<40} {:>7}", group, count);
  for (const long n : verdicts) fmt::print(" {:>9}", n);
  fmt::print(" {:>9.1e} {:>9.1e}\n", scalar, lanes);
  return verdicts[std::size_t(Verdict::kWrong)];
}

}  // namespace

int main(int argc, char** argv) {
  const auto number = [&](int k, long otherwise) { return argc > k ? std::atol(argv[k]) : otherwise; };
  const long motions = number(1, 200), scenes = number(2, 1000);
  const auto seed = std::uint64_t(number(3, 1));
  const SeaParameters<double> sea = read_actuator(UKEMI_DATASETS "/actuators/table2.toml").sea;
  fmt::print("{:<40} {:>7} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9}\n", "landings", "", "pass", "sensitive", "coarse",
             "refused", "wrong", "scalar", "lanes");
  long wrong = 0;
  for (const std::string name : kScenes) {
    const Scene scene = read_scene(UKEMI_DATASETS "/scenes/" + name + ".toml");
    wrong += follow(name, motions, [&](std::uint64_t i) { return random_motion(scene, sea, seed, i); });
  }
  const Scene paper = read_scene(UKEMI_DATASETS "/scenes/paper.toml");
  const Draw landing = [&](std::uint64_t i) { return random_landing(paper, sea, seed, i); };
  wrong += follow("random scenes", scenes, landing);
  wrong += follow("random scenes, every term of the drive", scenes,
                  [&](std::uint64_t i) { return with_drive_terms(landing(i), seed, i); });
  return wrong > 0;
}

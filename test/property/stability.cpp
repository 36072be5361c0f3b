// A reduced grid of `ukemi bench stability`: steps are bounded, not seconds. Every case passes, is earned sensitive, or
// is refused with a reason; at most 2 % are refused.
#include <catch2/catch.hpp>
#include <cstdlib>

#include "common/actuator.hpp"
#include "landing/judge/sensitivity.hpp"
#include "landing/lanes/batch.hpp"
#include "landing/model/scene_file.hpp"
#include "test/three_ways.hpp"

using namespace ukemi;
using namespace ukemi::landing;

TEST_CASE("stability: stiff and extreme landings pass, are sensitive, or are refused with a reason") {
  const Scene scene = read_scene(UKEMI_DATASETS "/scenes/paper.toml");
  const SeaParameters<double> sea = read_actuator(UKEMI_DATASETS "/actuators/table2.toml").sea;
  constexpr long kMaxSteps = 50'000;
  int cases = 0, refused = 0, beyond = 0, sensitive = 0;
  for (const StabilityCase& c : stability_grid(scene, sea, 60, 1, 2)) {
    const StabilityResult r = check_stability(c, {.max_steps = kMaxSteps});
    INFO(c.factor << " " << c.setting << ": " << name(r.verdict) << " " << r.reason);
    CHECK(r.verdict != Verdict::kWrong);
    CHECK(r.work.steps <= kMaxSteps + 1);
    ++cases, sensitive += r.verdict == Verdict::kSensitive;
    if (r.verdict != Verdict::kRefused) {
      CHECK(r.energy_residual <= 1e-6);
      CHECK(std::isfinite(r.peak));
    } else {
      CHECK(!r.reason.empty());
      // Here the bound on steps is an eighth of the bench's: what runs into it is counted apart.
      ++(r.failure == Failure::kSteps ? beyond : refused);
    }
    if (r.verdict == Verdict::kSensitive) CHECK(r.sensitivity > 1e-3);
  }
  CAPTURE(cases, refused, beyond, sensitive);
  CHECK(cases > 120);
  CHECK(refused * 50 <= cases);
  CHECK(beyond * 8 <= cases);
}

// The reduced form of `bench_three_ways 10000 10000` (test/bench), which with seed 1 gave: 100,000 random
// motions on the ten shipped scenes: 99,990 agree (largest difference to 1e-11: scalar 5.2e-6, lanes 7.8e-4), 1
// sensitive, 5 coarse, 4 refused, none wrong; 10,000 random robots, floors, drops, actuators and motions: 8,904 agree
// (5.7e-6, 9.5e-4), 869 sensitive, 2 coarse, 225 refused, none wrong.
TEST_CASE("stability: the scalar path, a hundred times tighter, and lanes give one peak, or the landing is sensitive") {
  const SeaParameters<double> sea = read_actuator(UKEMI_DATASETS "/actuators/table2.toml").sea;
  const Scene paper = read_scene(UKEMI_DATASETS "/scenes/paper.toml"),
              tilted = read_scene(UKEMI_DATASETS "/scenes/tilted.toml");
  constexpr std::uint64_t kSeed = 7;
  std::vector<StabilityCase> cases;
  for (std::uint64_t i = 0; i < 300; ++i) cases.push_back(random_motion(paper, sea, kSeed, i));
  for (std::uint64_t i = 0; i < 300; ++i) cases.push_back(random_motion(tilted, sea, kSeed, i));
  // A hip that touches within 3 microseconds of a chattering foot: once the lanes took thirty steps to each event.
  for (const std::uint64_t i : {1381u, 1527u}) cases.push_back(random_motion(tilted, sea, kSeed, i));
  for (std::uint64_t i = 0; i < 150; ++i) cases.push_back(random_landing(paper, sea, kSeed, i));
  const auto results = cross_check(cases, 0);
  int refused = 0, sensitive = 0;
  for (std::size_t i = 0; i < results.size(); ++i) {
    const CrossCheck& c = results[i];
    INFO(cases[i].factor << " " << cases[i].setting << ": " << name(c.verdict) << " " << c.reason << "; scalar "
                         << c.scalar << " lanes " << c.lanes << " tight " << c.tight);
    CHECK(c.verdict != Verdict::kWrong);
    if (c.verdict == Verdict::kSensitive) CHECK(c.sensitivity > kCliff);
    refused += c.verdict == Verdict::kRefused, sensitive += c.verdict == Verdict::kSensitive;
  }
  CAPTURE(refused, sensitive);
  CHECK(refused <= 8);     // points that hover on y = 0 (tools/docs/limits.md)
  CHECK(sensitive <= 30);  // drives that whirl the robot for seconds
}

// A longer campaign: UKEMI_CAMPAIGN=100000 (a landing takes some 15 ms).
TEST_CASE("stability: lanes as risk uses them give the peak of drives with every term, or the landing is sensitive") {
  const SeaParameters<double> sea = read_actuator(UKEMI_DATASETS "/actuators/table2.toml").sea;
  const Scene paper = read_scene(UKEMI_DATASETS "/scenes/paper.toml");
  const char* asked = std::getenv("UKEMI_CAMPAIGN");
  const long landings = asked ? std::atol(asked) : 200;
  constexpr std::uint64_t kSeed = 3;
  constexpr double kRiskAccuracy = 1e-6;
  long refused = 0, sensitive = 0, off = 0;
  for (long i = 0; i < landings; ++i) {
    const auto index = std::uint64_t(i);
    const StabilityCase c = with_drive_terms(
        i % 2 ? random_landing(paper, sea, kSeed, index) : random_motion(paper, sea, kSeed, index), kSeed, index);
    const LandingPeak tight = peak_acceleration(c.scene, c.sea, c.motion, {.accuracy = 1e-11});
    LandingPeak lane;
    const BatchCase one{&c.scene, &c.sea, c.motion};
    batch_peaks({&one, 1}, {&lane, 1}, {.accuracy = kRiskAccuracy});
    if (tight.end == End::kFailed || lane.end == End::kFailed)
      ++refused;
    else if (std::abs(lane.peak / tight.peak - 1) > kCliff) {
      const Sensitivity s = sensitivity(c.scene, c.sea, c.motion, {.accuracy = 1e-9}, tight.peak, 64);
      ++(s.sensitive ? sensitive : off);
      if (!s.sensitive) WARN(c.factor << " " << c.setting << ": lanes " << lane.peak << " for " << tight.peak);
    }
  }
  CAPTURE(landings, refused, sensitive, off);
  CHECK(off * 1000 <= landings);  // a touchdown beside another point's chatter may be met late
  CHECK(refused * 20 <= landings);
  CHECK(sensitive * 10 <= landings);
}

TEST_CASE("stability: only runs that are right earn a landing the word sensitive") {
  const Scene scene = read_scene(UKEMI_DATASETS "/scenes/paper.toml");
  const SeaParameters<double> sea = read_actuator(UKEMI_DATASETS "/actuators/table2.toml").sea;
  const Motion motion{-0.7, -1.2, 0.25};
  const double peak = peak_acceleration(scene, sea, motion).peak;
  const Sensitivity good = sensitivity(scene, sea, motion, {}, peak);
  CHECK(good.right);
  CHECK(!good.sensitive);
  CHECK(good.error_estimate < 1e-6);
  // A number that is not this landing's moves with the tolerance, not with the scene.
  const Sensitivity bad = sensitivity(scene, sea, motion, {}, 1e17);
  CHECK(!bad.right);
  CHECK(!bad.sensitive);
}

TEST_CASE("stability: a stiff landing is followed by implicit steps, a plain one by explicit ones") {
  const Scene scene = read_scene(UKEMI_DATASETS "/scenes/paper.toml");
  SeaParameters<double> sea = read_actuator(UKEMI_DATASETS "/actuators/table2.toml").sea;
  const Motion motion{-0.7, -1.2, 0.25};
  const LandingPeak plain = peak_acceleration(scene, sea, motion);
  CHECK(plain.work.implicit == 0);
  sea.c_sea = 1e5;  // an explicit step would be bounded by 4e-7 s
  const LandingPeak stiff = peak_acceleration(scene, sea, motion);
  CHECK(stiff.end == End::kRest);
  CHECK(stiff.work.implicit > stiff.work.steps / 2);
  CHECK(stiff.work.steps < 20'000);
}

// Stopping at rest (landing/body/body_rest.hpp) must not change the peak: a run that stops is compared with the same
// run followed to its time limit. The steps are the same until the stop, so the peaks agree to the last bit or not at
// all.
#include <catch2/catch.hpp>

#include "common/actuator.hpp"
#include "common/random.hpp"
#include "landing/lanes/batch.hpp"
#include "landing/model/scene_file.hpp"
#include "landing/run/simulate.hpp"
#include "landing/search/optimize.hpp"

using namespace ukemi;
using namespace ukemi::landing;

TEST_CASE("rest: no later peak exceeds that of a run stopped at rest") {
  const auto floor = GENERATE("paper", "paper_rough_a", "paper_rough_b", "paper_soft");
  constexpr std::uint64_t kSeed = 20240603;
  constexpr int kMotions = 400;
  INFO(floor << ", seed " << kSeed);
  const Scene scene = read_scene(std::string(UKEMI_DATASETS "/scenes/") + floor + ".toml");
  const SeaParameters<double> sea = read_actuator(UKEMI_DATASETS "/actuators/table2.toml").sea;
  int rested = 0;
  double stopped_at = 0, nearest = 0;
  for (int i = 0; i < kMotions; ++i) {
    Random r(kSeed, std::uint64_t(i));
    const auto [phi, duration] = scene.search;
    const Motion m{r.uniform(phi[0], phi[1]), r.uniform(phi[0], phi[1]), r.uniform(duration[0], duration[1])};
    INFO("draw " << i << ": " << m.phi_i << " " << m.phi_f << " " << m.duration);
    const LandingPeak stopped = peak_acceleration(scene, sea, m, {.accuracy = 1e-8});
    const Landing followed = simulate(scene, sea, m, {.accuracy = 1e-8, .rest = SimulateOptions::Rest::kIgnore});
    REQUIRE(stopped.end != End::kFailed);
    CHECK(followed.end == End::kTimeLimit);
    CHECK(followed.t_end > 10);
    CHECK(stopped.peak == followed.peak);
    CHECK(stopped.t_peak == followed.t_peak);
    if (stopped.end != End::kRest) continue;
    ++rested;
    stopped_at += stopped.t_end;
    CHECK(stopped.t_end < followed.t_end);
    CHECK(stopped.work.steps < followed.work.steps);
    // How near did it come? The largest peak of an interval between touchdowns that lies after the stop, over the peak.
    // Free of contact it would be g at least.
    for (const Peak& p : followed.peaks)
      if (p.t > stopped.t_end) nearest = std::max(nearest, p.acceleration / stopped.peak);
  }
  const double share = double(rested) / kMotions, mean = stopped_at / rested;
  INFO("at rest " << share << ", after " << mean << " s on average; largest later acceleration / peak " << nearest);
  CHECK(share >= 0.98);   // otherwise the test above compares a run with itself
  CHECK(mean < 2);        // against the ten seconds that a run may last: stopping is worth having
  CHECK(nearest < 0.05);  // not by luck
}

TEST_CASE("rest: a robot that is slow but not supported goes on") {
  // Held straight up on its foot, a robot topples however slowly it starts. A drop from nothing, all but upright.
  Scene scene = read_scene(UKEMI_DATASETS "/scenes/paper.toml");
  const SeaParameters<double> sea = read_actuator(UKEMI_DATASETS "/actuators/table2.toml").sea;
  scene.drop = {.height = 0, .forward_speed = 0, .pitch = 1e-4};
  const Motion held{0, 0, 0.1};
  const Landing landing = simulate(scene, sea, held);
  REQUIRE(landing.end == End::kRest);
  CHECK(landing.t_end > 1);
  REQUIRE(landing.touches.size() >= 2);
  CHECK(landing.touches.front().point == kFoot);
  CHECK(landing.touches.back().t_touchdown > 0.5);  // it stood for that long before anything else touched
  CHECK(landing.peak > 50);                         // the fall, not the standing
  CHECK(landing.peak == simulate(scene, sea, held, {.rest = SimulateOptions::Rest::kIgnore}).peak);
}

TEST_CASE("rest: what only a damper holds is not at rest") {
  const SeaParameters<double> table2 = read_actuator(UKEMI_DATASETS "/actuators/table2.toml").sea;
  const Motion held{-0.8, -0.8, 1};
  Scene scene = read_scene(UKEMI_DATASETS "/scenes/paper.toml");
  SECTION("a floor without stiffness: the robot sinks on, slowly") {
    scene.floor->stiffness = 1e-9;
    const Landing l = simulate(scene, table2, held);
    CHECK(l.end == End::kTimeLimit);
  }
  SECTION("a spring without stiffness: the joint gives way, slowly") {
    SeaParameters<double> sea = table2;
    sea.k_sea = 1e-9, sea.c_sea = 20;
    const Landing l = simulate(scene, sea, held);
    CHECK(l.end == End::kTimeLimit);
  }
}

TEST_CASE("flight: a fall from any height meets the floor, one that cannot is no landing") {
  const SeaParameters<double> sea = read_actuator(UKEMI_DATASETS "/actuators/table2.toml").sea;
  const Motion motion{-0.7, -1.2, 0.25};
  Scene scene = read_scene(UKEMI_DATASETS "/scenes/paper.toml");
  const auto lanes = [&] {
    const BatchCase c{&scene, &sea, motion};
    LandingPeak p;
    batch_peaks({&c, 1}, {&p, 1}, {.accuracy = 1e-6});
    return p.end;
  };
  SECTION("from 1 km, turning or not") {
    scene.drop.height = 1000, scene.drop.pitch_rate = GENERATE(0.0, 0.5);
    const LandingPeak l = peak_acceleration(scene, sea, motion);
    CHECK(l.contacts.size() > 0);
    CHECK(l.t_end > std::sqrt(2 * 999 / 9.81));
    CHECK(lanes() != End::kNoContact);
  }
  SECTION("no gravity, no point, or the end comes first") {
    const int what = GENERATE(0, 1, 2, 3);
    if (what == 0) scene.robot.gravity = 0;
    if (what == 1) scene.contacts = {};
    if (what == 2) scene.t_end = 0.2;
    if (what == 3) scene.t_end = 0.2, scene.drop.pitch_rate = 0.1;
    CHECK(peak_acceleration(scene, sea, motion).end == End::kNoContact);
    CHECK(lanes() == End::kNoContact);
    const Optimum best = optimize(scene, sea, {.evaluations = 50});
    CHECK(!best.found);
    CHECK_THAT(best.message, Catch::Matchers::Contains("no point of the robot touches the floor"));
  }
}

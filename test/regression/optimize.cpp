// Eq. 6 on the paper's scene: what the default search reaches, and that its value is real.
#include <catch2/catch.hpp>

#include "common/actuator.hpp"
#include "common/degrees.hpp"
#include "landing/model/scene_file.hpp"
#include "landing/search/optimize.hpp"
#include "landing/search/solvers.hpp"
#include "landing/search/tolerant_peak.hpp"

using namespace ukemi;
using namespace ukemi::landing;

TEST_CASE("the default search ends at 176 or lower with seeds 1 to 5") {
  const Scene scene = read_scene(UKEMI_DATASETS "/scenes/paper.toml");
  const SeaParameters<double> sea = read_actuator(UKEMI_DATASETS "/actuators/table2.toml").sea;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    OptimizeOptions options;
    options.seed = seed;
    const Optimum o = optimize(scene, sea, options);
    INFO("seed " << seed << " peak " << o.landing.peak);
    REQUIRE(o.found);
    CHECK(o.landing.peak <= 176);
    CHECK(o.evaluations <= default_evaluations(options.goal));
    const double tight = simulate(scene, sea, o.motion, {.accuracy = 1e-12}).peak;
    CHECK(std::abs(tight - o.landing.peak) < 1e-6 * tight);
    CHECK(o.tolerant.value >= o.landing.peak);
    for (const double phi : {o.motion.phi_i, o.motion.phi_f}) {
      CHECK(phi >= scene.search.phi[0]);
      CHECK(phi <= scene.search.phi[1]);
    }
  }
}

TEST_CASE("a search does not depend on the number of threads") {
  const Scene scene = read_scene(UKEMI_DATASETS "/scenes/paper_soft.toml");
  const SeaParameters<double> sea = read_actuator(UKEMI_DATASETS "/actuators/table2.toml").sea;
  const auto run = [&](int threads) {
    OptimizeOptions o;
    o.evaluations = 1500, o.threads = threads, o.seed = 7;
    return optimize(scene, sea, o);
  };
  const Optimum one = run(1), three = run(3);
  CHECK(one.motion.phi_i == three.motion.phi_i);
  CHECK(one.motion.phi_f == three.motion.phi_f);
  CHECK(one.motion.duration == three.motion.duration);
  CHECK(one.landing.peak == three.landing.peak);
  CHECK(one.tolerant.value == three.tolerant.value);
  CHECK(one.evaluations == three.evaluations);
}

TEST_CASE("every solver returns a motion of the range and its own best") {
  const Scene scene = read_scene(UKEMI_DATASETS "/scenes/paper.toml");
  const SeaParameters<double> sea = read_actuator(UKEMI_DATASETS "/actuators/table2.toml").sea;
  for (const std::string& solver : solver_names()) {
    OptimizeOptions o;
    o.solver = solver, o.evaluations = 300, o.tolerance_samples = 0;
    const Optimum best = optimize(scene, sea, o);
    INFO(solver << " " << best.landing.peak);
    CHECK(best.found);
    CHECK(best.landing.peak < 520);  // the median of random motions is 513
    CHECK(best.evaluations == 300);
  }
}

TEST_CASE("the check inside a wide execution box finds the crack that its fifteen points do not see") {
  Scene scene = read_scene(UKEMI_DATASETS "/scenes/paper.toml");
  const SeaParameters<double> sea = read_actuator(UKEMI_DATASETS "/actuators/table2.toml").sea;
  const Motion motion{-23.39208294612951 * kDegree, -89.85599420713379 * kDegree, 0.2631552963096708};
  scene.execution = {0.5 * kDegree, 0.005};
  for (const int threads : {1, 3}) {
    const TolerantPeak t = tolerant_peak(scene, sea, motion, {.accuracy = 1e-9}, 2000, 1, threads);
    CHECK(t.value == Approx(198.60707980665129).epsilon(1e-7));
    CHECK(t.sampled > 310);  // 1 to 3 of a thousand points
    CHECK(t.sampled < 315);
    CHECK(t.samples == 2000);
    CHECK_FALSE(t.failed);
  }
  // The box that a robot holds has none.
  const Motion held{-32.52136986430067 * kDegree, -21.570260293902773 * kDegree, 0.376003380264452};
  scene.execution = {};
  const TolerantPeak t = tolerant_peak(scene, sea, held, {.accuracy = 1e-9}, 2000, 1, 2);
  CHECK(t.value == Approx(188.72154394022812).epsilon(1e-7));
  CHECK(t.sampled <= t.value);
}

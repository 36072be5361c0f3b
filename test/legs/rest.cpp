// A run that stops at rest loses no later peak.
#include <catch2/catch.hpp>

#include "common/random.hpp"
#include "landing/body/body_run.hpp"
#include "landing/plan/body_space.hpp"
#include "test/legs/robots.hpp"

using namespace ukemi;
using namespace ukemi::landing;

TEST_CASE("legs: stopping at rest does not change the peak, and spares most of the run", "[legs]") {
  constexpr std::uint64_t kSeed = 5;
  constexpr int kMotions = 60;
  INFO("seed " << kSeed);
  for (const std::string name : {"hopper", "foot", "three_links"}) {
    const BodyScene shipped = legs::shipped(name);
    const BodySpace space(shipped);
    int at_rest = 0;
    double end = 0;
    for (std::uint64_t i = 0; i < kMotions; ++i) {
      Random r(kSeed, i);
      CAPTURE(name, i);
      Coordinates u(space.dimension());
      for (double& x : u) x = r.uniform();
      BodyScene scene = shipped;
      scene.drop.height *= r.uniform(0.5, 1.5);
      if (scene.robot.base == Base::kFree)
        scene.drop.pitch += r.uniform(-0.3, 0.3), scene.drop.forward_speed += r.uniform(-0.5, 0.5);
      const BodyMotion motion = space.motion(u);
      const BodyLanding stopped = peak_acceleration(scene, motion),
                        followed = peak_acceleration(scene, motion, {.rest = SimulateOptions::Rest::kIgnore});
      CHECK(followed.peak <= stopped.peak * (1 + 1e-6));
      at_rest += stopped.end == End::kRest, end += stopped.t_end / kMotions;
    }
    CHECK(at_rest >= kMotions - 2);
    CHECK(end < 2);  // [s], where a run to its time limit takes 10
  }
}

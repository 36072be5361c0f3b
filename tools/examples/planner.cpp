// A robot's control program that owns a planner: set up once, then an answer for every fall, by its deadline.
//
//     planner SCENE.toml ACTUATOR.toml HEIGHT PITCH_DEG FORWARD_SPEED
//
// What a real robot would do between the lines: measure the drop when it feels weightless, send the reference to the
// drive, and start it at the first touchdown.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "common/actuator.hpp"
#include "landing/model/release.hpp"
#include "landing/model/scene_file.hpp"
#include "landing/search/planner.hpp"

int main(int argc, char** argv) {
  if (argc != 6) {
    std::fprintf(stderr, "planner SCENE.toml ACTUATOR.toml HEIGHT PITCH_DEG FORWARD_SPEED\n");
    return 2;
  }
  try {
    using namespace ukemi;
    constexpr double kDegrees = 57.29577951308232, kReaction = 0.5;  // of the fall is left for the drive to get ready
    landing::Scene scene = landing::read_scene(argv[1]);
    landing::Planner planner(scene, read_actuator(argv[2]).sea);  // all memory is taken here

    scene.drop.height = std::atof(argv[3]);
    scene.drop.pitch = std::atof(argv[4]) / kDegrees;
    scene.drop.forward_speed = std::atof(argv[5]);
    const double fall = landing::fall_time(scene);
    const landing::Plan plan = planner.plan(scene.drop, kReaction * fall);  // no allocation, no thread
    if (!plan.found) {
      std::printf("no plan in %.0f ms\n", 1e3 * kReaction * fall);
      return 1;
    }
    std::printf(
        "fall %.0f ms, planned in %.0f ms: %.2f deg to %.2f deg in %.4f s, worst peak %.1f m/s^2 (%ld motions)\n",
        1e3 * fall, 1e3 * kReaction * fall, plan.motion.phi_i * kDegrees, plan.motion.phi_f * kDegrees,
        plan.motion.duration, plan.value, plan.motions);
    return 0;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "planner: %s\n", e.what());
    return 2;
  }
}

// Plays a plan on a robot: the control loop of tools/docs/play.md, with a stand-in for the robot.
//
//     play ROBOT_SCENE.toml [MOTION.toml]
//
// Without a motion file it plans one at the release; the robot must then have two joints.
#include <cstdio>
#include <optional>
#include <stdexcept>
#include <string>

#include <ukemi/landing/body_planner.hpp>
#include <ukemi/landing/body_run.hpp>
#include <ukemi/landing/player.hpp>

namespace {

using namespace ukemi::landing;

/// Stands for the real robot: it falls as simulated and feels the floor from the first touchdown on. Its drives limit
/// the step of a command.
struct StandIn {
  BodyLanding fall;
  double clock = 100;  // the robot's own time [s], any origin
  double released_at = 100.05;
  bool weightless() const { return clock >= released_at; }
  bool feels_floor() const { return clock >= released_at + fall.contacts.first(); }
  std::optional<double> sent[kMaxJoints];
  void send(int k, const DriveCommand& c) {
    constexpr double kMaxStep = 0.35;  // change of a command within one period [rad]
    const double last = sent[k].value_or(c.phi);
    if (!(c.phi > last - kMaxStep && c.phi < last + kMaxStep))
      throw std::runtime_error("joint " + std::to_string(k) + " would jump to " + std::to_string(c.phi) + " rad");
    sent[k] = c.phi;
  }
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2 && argc != 3) {
    std::fprintf(stderr, "play ROBOT_SCENE.toml [MOTION.toml]\n");
    return 2;
  }
  try {
    const BodyScene scene = read_body_scene(argv[1]);
    BodyMotion motion = argc == 3 ? read_body_motion(argv[2], scene.robot) : held_posture(scene);
    if (argc == 2) {
      // Construct once; plan for each measured fall, here at the release.
      BodyPlanner planner(scene);
      const BodyFallState now{.height = 0.3, .joints = {{0.6, 0}, {-1.2, 0}}, .pitch = 0, .elapsed = 0};
      const BodyAnswer answer = planner.plan(now, 0.1);  // from then on the references may move
      if (answer.found()) motion = answer.plan.motion;
    }
    StandIn robot{simulate(scene, motion)};
    constexpr double kPeriod = 1e-3;  // of the loop [s]
    bool falling = false;

    Player player(motion);  // allocates here only
    for (; !(robot.clock > player.end() + 0.1); robot.clock += kPeriod) {
      if (!falling && robot.weightless()) falling = player.released(robot.clock);
      if (falling && !player.landing() && robot.feels_floor()) player.touchdown(robot.clock);
      for (int k = 0; k < player.joints(); ++k) robot.send(k, player.at(k, robot.clock));
    }
    std::printf("touched down %.4f s after release, at rest in the last posture:", robot.fall.contacts.first());
    for (int k = 0; k < player.joints(); ++k)
      if (scene.robot.joints[std::size_t(k)].driven())
        std::printf(" %s %.3f rad", scene.robot.joints[std::size_t(k)].name.c_str(), *robot.sent[k]);
    std::printf("\n");
    return 0;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "play: %s\n", e.what());
    return 2;
  }
}

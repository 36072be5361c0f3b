// Plays a plan on a robot: the control loop of tools/docs/play.md, with a stand-in for the robot.
//
//     play ROBOT_SCENE.toml MOTION.toml
#include <cstdio>
#include <exception>
#include <string>

#include <ukemi/landing/body_run.hpp>
#include <ukemi/landing/player.hpp>

namespace {

using namespace ukemi::landing;

/// Stands for the real robot: it falls as the simulation says, and weighs on its feet from the first touchdown on.
struct StandIn {
  BodyLanding fall;
  double clock = 100;  // [s], of the robot: any origin
  double released_at = 100.05;
  bool weightless() const { return clock >= released_at; }
  bool feels_floor() const { return clock >= released_at + fall.first_touchdown; }
  void send(int, const DriveCommand&) {}
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "play ROBOT_SCENE.toml MOTION.toml\n");
    return 2;
  }
  try {
    const BodyScene scene = read_body_scene(argv[1]);
    const BodyMotion motion = read_body_motion(argv[2], scene.robot);
    StandIn robot{simulate(scene, motion)};
    constexpr double kPeriod = 1e-3, kStray = 0.35;  // of the loop [s]; of a command within one period [rad]

    Player player(motion);  // allocates here, and never again
    bool falling = false;
    double last[kMostJoints];
    for (int k = 0; k < player.joints(); ++k) last[k] = player.at(k, robot.clock).phi;
    for (; !(robot.clock > player.end() + 0.1); robot.clock += kPeriod) {
      if (!falling && robot.weightless()) falling = player.released(robot.clock);
      if (falling && !player.landing() && robot.feels_floor()) player.touchdown(robot.clock);
      for (int k = 0; k < player.joints(); ++k) {
        const DriveCommand c = player.at(k, robot.clock);
        if (!(c.phi > last[k] - kStray && c.phi < last[k] + kStray)) {  // the robot's own safety limit
          std::fprintf(stderr, "play: joint %d would jump by %.2f rad\n", k, c.phi - last[k]);
          return 1;
        }
        robot.send(k, c), last[k] = c.phi;
      }
    }
    std::printf("touched down %.4f s after release, at rest in the last posture:", robot.fall.first_touchdown);
    for (int k = 0; k < player.joints(); ++k)
      if (scene.robot.joints[std::size_t(k)].driven())
        std::printf(" %s %.3f rad", scene.robot.joints[std::size_t(k)].name.c_str(), last[k]);
    std::printf("\n");
    return 0;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "play: %s\n", e.what());
    return 2;
  }
}

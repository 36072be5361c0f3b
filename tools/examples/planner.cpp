// A robot's control program with a planner, from the moment at which it feels weightless.
//
//     planner SCENE.toml ACTUATOR.toml HEIGHT PITCH_DEG FORWARD_SPEED PHI_DEG
//
// Every 20 ms it measures the fall and plans anew; it sends the drive the move in the air, timed from now, and the
// landing motion, which starts when the touchdown is felt. Robot stands for the real one: it falls as simulated,
// without noise, and its spring is relaxed at each new reference, as a plan assumes.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <optional>

#include <ukemi/actuator.hpp>
#include <ukemi/landing/planner.hpp>
#include <ukemi/landing/scene_file.hpp>
#include <ukemi/landing/simulate.hpp>

namespace {

using namespace ukemi;
using namespace ukemi::landing;
constexpr double kDegrees = 57.29577951308232;  // degrees per radian
constexpr double kPeriod = 0.02;                // between two plans, and time limit of each [s]
constexpr double kFallback = -0.87;  // angle held where nothing was found: it lands softly without moving [rad]

class Robot {
 public:
  Robot(const Scene& scene, const SeaParameters<double>& sea, double phi) : scene_(scene), sea_(sea) {
    scene_.release.reset();
    send({phi, phi, 1}, 0);
  }
  /// Sets the reference from `now` on.
  void send(const Motion& motion, double now) {
    if (!landing_.trajectory.empty()) {
      const FallState s = measured(now);
      scene_.drop = {s.height, s.forward_speed, s.pitch, s.pitch_rate, *s.vertical_speed};
    }
    motion_ = motion, sent_at_ = now;
    landing_ = simulate(scene_, sea_, motion, {}, 1000);
  }
  double touchdown() const { return sent_at_ + landing_.contacts.first(); }
  FallState measured(double now) const {
    const auto after = [&](const Sample& s) { return sent_at_ + s.t >= now - 1e-9; };
    const Sample& s = *std::find_if(landing_.trajectory.begin(), landing_.trajectory.end() - 1, after);
    const double half = 0.5 * scene_.robot.link_length, hip = s.y0 + half * std::cos(s.phi0),
                 knee = s.y0 - half * std::cos(s.phi0), foot = knee - 2 * half * std::cos(s.phi0 + s.phi1);
    double lowest = std::numeric_limits<double>::infinity();
    for (const auto& [point, y] : {std::pair{kHip, hip}, {kKnee, knee}, {kFoot, foot}})
      if (scene_.contacts[point]) lowest = std::min(lowest, y);
    return {std::max(0.0, lowest), s.dx0, s.phi0, s.dphi0, s.phi1, s.dphi1, now, s.dy0};
  }
  double peak() const { return landing_.peak; }

 private:
  Scene scene_;
  SeaParameters<double> sea_;
  Motion motion_{};
  double sent_at_ = 0;
  Landing landing_;
};

int control(Scene scene, const SeaParameters<double>& sea, double phi) {
  Robot robot(scene, sea, phi);
  const double held = robot.peak();
  scene.release = Release{phi};
  Planner planner(scene, sea, {.goal = Goal::kPeak});  // all memory is taken here
  std::optional<Plan> sent;
  for (double now = 0; now + 2 * kPeriod < robot.touchdown(); now += kPeriod) {
    const Plan plan = planner.plan(robot.measured(now), kPeriod);  // no allocation, no thread
    // Where nothing is found, no time is left or a sensor fails, the present plan continues; so it does where the new
    // one is no better.
    if (!plan.found() || (sent && plan.value >= sent->value)) continue;
    sent = plan;
    robot.send(plan.motion, now);
    std::printf(
        "%3.0f ms: %.0f deg by %3.0f ms; from the touchdown to %.0f deg in %.0f ms; peak %.1f m/s^2 (%ld motions)\n",
        1e3 * now, plan.motion.phi_i * kDegrees, 1e3 * (now + plan.motion.reposition->to), plan.motion.phi_f * kDegrees,
        1e3 * plan.motion.duration, plan.value, plan.motions);
  }
  if (!sent) {
    robot.send({kFallback, kFallback, 1}, 0);
    std::printf("no plan: %.0f deg is held\n", kFallback * kDegrees);
  }
  // A real drive starts the landing motion when it feels the touchdown. Where it never does, the last posture of the
  // move in the air is held: the motion must not be started by time alone.
  if (std::isinf(robot.touchdown())) {
    std::printf("no touchdown was felt: the posture is held\n");
    return 1;
  }
  std::printf("touchdown after %.0f ms; peak %.1f m/s^2; had the joint been held at %.0f deg, %.1f\n",
              1e3 * robot.touchdown(), robot.peak(), phi * kDegrees, held);
  return sent ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 7) {
    std::fprintf(stderr, "planner SCENE.toml ACTUATOR.toml HEIGHT PITCH_DEG FORWARD_SPEED PHI_DEG\n");
    return 2;
  }
  try {
    Scene scene = read_scene(argv[1]);
    scene.freedom.bumps = 2;
    scene.drop = {std::atof(argv[3]), std::atof(argv[5]), std::atof(argv[4]) / kDegrees};
    return control(scene, read_actuator(argv[2]).sea, std::atof(argv[6]) / kDegrees);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "planner: %s\n", e.what());
    return 2;
  }
}

// Pushes of a robot between the rows of its log: hits that are smooth and begin between two rows.
#include <algorithm>
#include <numbers>

#include "test/legs/hits.hpp"

using namespace ukemi;
using namespace ukemi::landing;
using namespace ukemi::tools;
using namespace legs;

namespace {

constexpr const char* kSmooth = "sensor.push_smooth";
constexpr double kRate = 1000;  // of the log [1/s]

/// Eight half-sine hits, simulated with the force as it is.
std::vector<identify::Trial> smooth_hits(double noise) {
  std::vector<identify::Trial> out;
  for (std::size_t m = 0; m < std::size(test::kEightHits); ++m) {
    Random random(31, m);
    const test::HitOf& hit = test::kEightHits[m];
    const double onset = 0.05 + random.uniform() / kRate, seconds = hit.seconds / 2;
    const std::function<double(double)> force = [&](double t) {
      const double s = (t - onset) / seconds;
      return s > 0 && s < 1 ? hit.newton * std::sin(std::numbers::pi * s) : 0;
    };
    identify::Trial log;
    log.file = "hit_" + std::to_string(m + 1);
    for (int i = 0; i <= 800; ++i) log.t.push_back(i / kRate), log.force.push_back(force(log.t.back()));
    log.phi = test::joint_angle(log.t, force, {});
    for (double& x : log.phi) x += noise * random.normal();
    out.push_back(std::move(log));
  }
  return out;
}

}  // namespace

TEST_CASE("a robot that is hit smoothly moves as the simulator that has the force itself", "[driven]") {
  Hits hits(smooth_hits(0), 1);
  const auto apart = [&](double smooth) {
    Sensors sensors;
    sensors.push_smooth = smooth;
    double out = 0;
    for (const RobotTrial& t : hits.trials) {
      const DrivenRollout r = roll_driven(hits.robot.scene.robot, hits.robot.path, *t.commands, {{{0, 0, 0}}}, t.log.t,
                                          {.step = 5e-5, .sensors = &sensors});
      REQUIRE(r.complete);
      for (std::size_t i = 0; i < t.log.t.size(); ++i)
        out = std::max(out, std::abs(r.joint[0][kAngle][i] - t.log.output[kAngle][i]));
    }
    return out;
  };
  INFO("linear " << apart(0) << " rad, smooth " << apart(1));
  CHECK(apart(1) < 5e-5);
  CHECK(apart(0) > 10 * apart(1));
}

TEST_CASE("slopes by the shape of pushes are the differences of the rollouts, at both ends too", "[driven]") {
  const Hits hits(smooth_hits(0), 1);
  const RobotTrials simulator(hits.robot, hits.trials, hits.options);
  const DropTerm& term = hits.options.terms[kSmooth];
  const std::vector<double>& t = hits.trials[4].log.t;
  const auto at = [&](double value) { return simulator.follow(4, {{&term, value}}, t, {}); };
  const FollowedDrop linear = at(0), smooth = at(1);
  for (const double value : {0.0, 0.4, 1.0}) {
    FollowedDrop here = at(value);
    REQUIRE(simulator.differentiate(4, {{&term, value}}, t, {}, here));
    double off = 0, size = 0;
    for (std::size_t i = 0; i < t.size(); ++i) {
      const double by = smooth.value[kAngle][i] - linear.value[kAngle][i];  // about linear in the force
      off = std::max(off, std::abs(here.slope[kAngle](long(i), 0) - by)), size = std::max(size, std::abs(by));
    }
    INFO(value << ": " << off << " of " << size);
    CHECK(off < 1e-2 * size);
  }
}

TEST_CASE("smooth pushes are asked for, and with them a robot's constants are within their errors", "[driven]") {
  Hits hits(smooth_hits(1e-4), 1.1);
  hits.options.errors = {{"drive.arm.control_delay", 0}, {"drive.arm.velocity_filter", 0}};
  const RobotFit linear = fit_robot(hits.robot, hits.trials, hits.options);
  REQUIRE(linear.converged);
  CHECK_FALSE(linear.trusted());
  REQUIRE(linear.tests.missing());
  CHECK(linear.tests.missing()->term == kSmooth);
  hits.options.terms.free.push_back(kSmooth);
  const RobotFit fit = fit_robot(hits.robot, hits.trials, hits.options);
  REQUIRE(fit.converged);
  CHECK(fit.robot.sensors.push_smooth > 0.95);
  CHECK(worst(fit) < 3.5);
  CHECK(fit.rms[kAngle] == Approx(1e-4).epsilon(0.05));
}

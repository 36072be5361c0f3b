// Sensors of driven robots: what a log says of what it measures is found with the robot's constants.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <numbers>

#include "test/legs/pendulum.hpp"

using namespace ukemi;
using namespace ukemi::landing;
using namespace ukemi::tools;
using namespace legs;

namespace {

using Truth = std::map<std::string, double>;

std::vector<std::string> with_sensors(std::vector<std::string> free, const Truth& sensors) {
  for (const auto& [name, value] : sensors) free.push_back(name);
  return free;
}
void check_sensors(const RobotFit& fit, const Truth& sensors) {
  REQUIRE(fit.converged);
  INFO("asks for " << (fit.tests.missing() ? fit.tests.missing()->term : "nothing"));
  CHECK_FALSE(fit.tests.model_rejected());
  for (const auto& [name, value] : sensors)
    for (const auto& e : fit.parameters) {
      if (e.name != name) continue;
      INFO(name << " " << e.value << ", true " << value);
      REQUIRE(e.std);
      CHECK(std::abs(e.value - value) < 4 * *e.std);
      CHECK(*e.std < 0.3 * (name.ends_with("gain") ? std::abs(value - 1) : std::abs(value)));
      CHECK(number_of(fit.robot, name) == e.value);
    }
}

constexpr double kPushRow = 4e-3;  // [s]
/// A hammer's hits, some way into a log [N].
double hit(double t) {
  double out = 0;
  for (const double at : {0.2, 0.9, 1.7})
    if (t > at && t < at + 0.1) out += 12 * std::pow(std::sin(std::numbers::pi * (t - at) / 0.1), 2);
  return out;
}

}  // namespace

TEST_CASE("gains and biases of what is measured are told from the robot's constants", "[driven]") {
  const Truth sensors = {{"sensor.phi_knee.gain", 1.03},
                         {"sensor.phi_knee.bias", 0.02},
                         {"sensor.torque_hip.gain", 0.9},
                         {"sensor.torque_hip.bias", 0.15}};
  Case c(Pendulum{}, 1.1, 1, 0, with_sensors(kFree, sensors));
  for (RobotTrial& t : c.trials) {
    for (double& x : t.log.output[joint_channel(1) + kAngle]) x = 1.03 * x + 0.02;
    for (double& x : t.log.output[joint_channel(0) + kTorque]) x = 0.9 * x + 0.15;
  }
  const RobotFit fit = fit_robot(c.robot, c.trials, c.options);
  check_sensors(fit, sensors);
  CHECK(fit.rms[joint_channel(1)] == Approx(2e-4).epsilon(0.1));
}

TEST_CASE("a load cell's gain, its bias and its clock are told where gravity and the drives are known", "[driven]") {
  const Truth sensors = {
      {"sensor.push_hammer_x.gain", 1.2}, {"sensor.push_hammer_x.bias", 0.3}, {"sensor.time_shift", 0.006}};
  const std::string push = "[[robot.push]]\nname = \"hammer\"\nlink = \"shank\"\nat = [0.2, 0]\n";
  const test::Folder folder;
  const DrivenRobot robot = read_driven_robot(folder.write("robot.toml", robot_of(Pendulum{}, 1) + push));
  Commands true_commands;
  std::vector<double> rows;
  for (int k = 0; k < 600; ++k) rows.push_back(kPushRow * k);
  true_commands.t = rows, true_commands.joint.resize(2), true_commands.push.resize(1);
  for (const double t : rows) true_commands.push[0][0].push_back(hit(t));
  const DrivenRollout happened =
      roll_driven(robot.scene.robot, robot.path, true_commands, {.joint = {{0.1, 0, 0}, {-0.2, 0, 0}}}, rows);
  REQUIRE(happened.complete);
  Random random(kSeed, 77);
  std::string log = "t,phi_hip,phi_knee,push_hammer_x\n";
  for (std::size_t k = 0; k < rows.size(); ++k)
    log += fmt::format("{},{:.9g},{:.9g},{:.9g}\n", rows[k], happened.joint[0][kAngle][k] + 2e-4 * random.normal(),
                       happened.joint[1][kAngle][k] + 2e-4 * random.normal(), 1.2 * hit(rows[k] + 0.006) + 0.3);
  const std::vector<RobotTrial> trials =
      read_robot_trials(folder.write("log.csv", log), robot.scene.robot, {.columns = ""});
  RobotFitOptions options;
  options.terms = robot_terms(robot, trials), options.threads = 2;
  options.terms.free = with_sensors({"drive.hip.friction", "drive.knee.viscous_friction"}, sensors);
  check_sensors(fit_robot(robot, trials, options), sensors);
}

TEST_CASE("slopes by sensors are the differences of what they read", "[driven]") {
  Case c(Pendulum{}, 1, 1, 0, kFree);
  const RobotTrials simulator(c.robot, c.trials, c.options);
  for (const char* name :
       {"sensor.torque_knee.gain", "sensor.torque_knee.bias", "sensor.phi_knee.gain", "sensor.phi_hip.bias"}) {
    const DropTerm& term = c.options.terms[name];
    const std::size_t channel = std::string(name).find("torque") != std::string::npos
                                    ? joint_channel(1) + kTorque
                                    : joint_channel(std::string(name).find("knee") != std::string::npos) + kAngle;
    const auto at = [&](double value) { return simulator.follow(0, {{&term, value}}, c.trials[0].log.t, {}); };
    const double value = simulator.value(term), step = 1e-4;
    FollowedDrop here = at(value);
    const Settings settings{{&term, value}};
    REQUIRE(simulator.differentiate(0, settings, c.trials[0].log.t, {}, here));
    const FollowedDrop low = at(value - step), high = at(value + step);
    double off = 0, size = 0;
    for (std::size_t k = 0; k < c.trials[0].log.t.size(); ++k) {
      const double by = (high.value[channel][k] - low.value[channel][k]) / (2 * step);
      off = std::fmax(off, std::abs(here.slope[channel](long(k), 0) - by)), size = std::fmax(size, std::abs(by));
    }
    INFO(name << " " << off << " of " << size);
    CHECK(off < 1e-3 * size);
  }
}

TEST_CASE("[sensor] of a robot's file is read and checked", "[driven]") {
  const test::Folder folder;
  const auto read = [&](const std::string& table) {
    return read_driven_robot(folder.write("robot.toml", robot_of(Pendulum{}, 1) + table));
  };
  const DrivenRobot robot = read("[sensor.phi_hip]\ngain = 1.01\n[sensor.ax]\nbias = -0.4\n");
  CHECK(number_of(robot, "sensor.phi_hip.gain") == 1.01);
  CHECK(number_of(robot, "sensor.phi_hip.bias") == 0);
  CHECK(number_of(robot, "sensor.ax.bias") == -0.4);
  CHECK(number_of(robot, "sensor.time_shift") == 0);
  const auto refused = [&](const std::string& table, const std::string& words) {
    CHECK_THROWS_WITH(read(table), Catch::Contains("robot.toml:") && Catch::Contains(words));
  };
  refused("[sensor.phi_toe]\ngain = 1\n", "phi_toe");
  refused("[sensor.phi_hip]\ngain = 0\n", "above 0");
  refused("[sensor.phi_hip]\nscale = 2\n", "scale");
  refused("[sensor]\ntime_shift = 1\n", "-0.1 to 0.1");
  for (const char* name : {"command.hip.gian", "command.tail.offset", "sensor.phi_toe.gain", "sensor.phi_hip"})
    refused(fmt::format("[identified]\norder = [\"{}\"]\ncovariance = [[1]]\n", name), name);
}

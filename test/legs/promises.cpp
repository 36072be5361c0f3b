// What a fit promises of logs that it has not seen, and what happens.
#include <catch2/catch.hpp>
#include <cmath>

#include "test/legs/pendulum.hpp"

using namespace ukemi;
using namespace ukemi::landing;
using namespace ukemi::tools;
using namespace legs;

namespace {

constexpr double kCoarse = 0.01;  ///< noise of the angles that are fitted [rad]

/// The robot of a fit to two coarse logs, and how well it is known.
DrivenRobot fitted(const Case& c) {
  const RobotFit fit = fit_robot(c.robot, c.trials, c.options);
  REQUIRE(fit.converged);
  DrivenRobot out = fit.robot;
  REQUIRE(out.known);
  CHECK(out.known->constants.order.size() == kFree.size());
  CHECK(out.known->rms.at("phi_knee") == Approx(kCoarse).epsilon(0.1));
  return out;
}

}  // namespace

TEST_CASE("a fit's band holds what comes", "[driven]") {
  const Pendulum p;
  double squares = 0, fits = 0, within = 0, samples = 0;
  for (int draw = 0; draw < 6; ++draw) {
    Case c(p, 1, 0, 0, kFree);
    for (int m = 0; m < 2; ++m)
      for (auto& t : read_robot_trials(c.folder.write("log.csv", log_of(p, 300, std::uint64_t(2 * draw + m), kCoarse)),
                                       c.robot.scene.robot, {.columns = ""}))
        c.trials.push_back(t);
    c.options.terms = robot_terms(c.robot, c.trials), c.options.terms.free = kFree;
    DrivenRobot robot = fitted(c);
    // Without noise what is off is the constants, with it the log too.
    for (const bool exact : {false, true}) {
      if (exact) robot.known->rms.clear();
      const auto next = read_robot_trials(
          c.folder.write("next.csv", log_of(p, 300, std::uint64_t(100 + draw), exact ? 1e-6 : kCoarse)),
          robot.scene.robot, {.columns = ""});
      const RobotFit predicted = predict_robot(robot, next, c.options);
      REQUIRE(predicted.bands.size() == 1);
      REQUIRE(predicted.bands[0].known());
      const DropResult& d = predicted.drops[0];
      double mean = 0;
      for (const std::size_t o : {std::size_t(kAngle), std::size_t(kJointSignals + kAngle)})
        for (std::size_t i = 0; i < d.value[o].size(); ++i) {
          const double off = std::abs(d.value[o][i] - next[0].log.output[o][i]), band = predicted.bands[0].band[o][i];
          if (exact)
            mean += std::pow(off / band * kNormal975, 2) / double(2 * d.value[o].size());
          else
            within += off <= band, ++samples;
        }
      squares += mean, fits += exact;
    }
  }
  INFO("rms z " << std::sqrt(squares / fits) << ", within " << within / samples);
  CHECK(std::sqrt(squares / fits) > 0.6);
  CHECK(std::sqrt(squares / fits) < 1.4);
  CHECK(within / samples == Approx(0.95).margin(0.02));
}

TEST_CASE("a band is how a prediction moves with the constants' errors", "[driven]") {
  const Pendulum p;
  const Case c(p, 1, 1, 0, kFree, 1e-6);
  DrivenRobot robot = c.robot;
  const double error = 0.002 * p.m2;
  robot.known = {{{"robot.link.shank.mass", "drive.knee.k_d"}, Eigen::Matrix2d{{error * error, 0}, {0, 0}}}, {}};
  const RobotFit here = predict_robot(robot, c.trials, c.options);
  robot.scene.robot.links[1].mass += error;
  const RobotFit moved = predict_robot(robot, c.trials, c.options);
  REQUIRE(here.bands.at(0).known());
  for (const std::size_t o : {std::size_t(kAngle), std::size_t(kJointSignals + kAngle), std::size_t(kTorque)}) {
    double squares = 0, off = 0;
    for (std::size_t i = 0; i < c.trials[0].log.t.size(); ++i) {
      const double change = std::abs(moved.drops[0].value[o][i] - here.drops[0].value[o][i]),
                   promised = std::sqrt(
                       std::max(0.0, std::pow(here.bands[0].band[o][i] / kNormal975, 2) - std::pow(here.noise[o], 2)));
      squares += change * change, off += std::pow(change - promised, 2);
    }
    INFO(c.trials[0].log.output.size() << " outputs, of output " << o << " off " << std::sqrt(off / squares));
    CHECK(off < 0.05 * 0.05 * squares);
  }
}

TEST_CASE("each run has constants of its own, and a run to come is promised what they scatter by", "[driven]") {
  const std::vector<double> of_run = {0.07, 0.12, 0.10};
  const std::string friction = "drive.hip.friction";
  std::vector<std::string> free = kFree;
  free.push_back("command.delay");
  Case c(Pendulum{}, 1, 0, 0, free);
  double mean = 0;
  for (std::size_t r = 0; r < of_run.size(); ++r) {
    Pendulum p;
    p.delay = 0.0017, p.dry[0] = of_run[r], mean += of_run[r] / double(of_run.size());
    for (auto& t : read_robot_trials(c.folder.write(fmt::format("run_{}.csv", r), log_of(p, 500, r, 1e-3)),
                                     c.robot.scene.robot, {.columns = "", .pieces = 1}))
      c.trials.push_back(t);
  }
  REQUIRE(c.trials.size() == 6);  // two pieces of each
  CHECK(runs_of(c.trials).size() == of_run.size());
  c.options.terms = robot_terms(c.robot, c.trials), c.options.terms.free = free;
  c.options.terms.upper[friction] = 0.2;
  const RobotFit shared = fit_robot(c.robot, c.trials, c.options);
  fit_per_run({friction}, c.trials, c.options);
  CHECK(c.options.terms.free.size() == free.size() + 2);
  CHECK(c.options.terms.upper.at(friction + "@3") == 0.2);
  const RobotFit fit = fit_robot(c.robot, c.trials, c.options);
  REQUIRE(fit.converged);
  CHECK(fit.rms[kAngle] < 0.5 * shared.rms[kAngle]);
  CHECK_FALSE(shared.trusted());
  CHECK(fit.trusted());
  double found = 0;
  for (std::size_t r = 0; r < of_run.size(); ++r)
    for (const auto& e : fit.parameters)
      if (e.name == fmt::format("{}@{}", friction, r + 1)) {
        CHECK(std::abs(e.value - of_run[r]) < 4 * *e.std);
        CHECK(*e.std < 0.05 * of_run[r]);
        found += e.value / double(of_run.size());
      }
  CHECK(number_of(fit.robot, friction) == Approx(found).epsilon(1e-12));
  CHECK(found == Approx(mean).epsilon(0.02));
  REQUIRE(fit.robot.known);
  const auto& [order, covariance] = fit.robot.known->constants;
  const auto at = std::find(order.begin(), order.end(), friction) - order.begin();
  REQUIRE(order.size() == free.size());
  CHECK(std::sqrt(covariance(at, at)) == Approx(0.0252).epsilon(0.05));  // the scatter of the three
  CHECK_THROWS_WITH(fit_per_run({"drive.hip.k_p"}, c.trials, c.options), Catch::Contains("it is not fitted"));
  CHECK_THROWS_WITH(fit_per_run({"drive.hip.frction"}, c.trials, c.options), Catch::Contains("drive.hip.frction"));
}

TEST_CASE("an encoder's zero is told, of each run its own, by gravity and by what was asked", "[driven]") {
  const std::vector<double> zeros = {-0.01, 0.03};
  const std::string zero = "command.hip.offset";
  std::vector<std::string> free = {zero, "robot.link.shank.mass", "drive.hip.friction", "drive.knee.friction"};
  Case c(Pendulum{}, 1, 0, 0, free);
  for (std::size_t r = 0; r < zeros.size(); ++r) {
    for (auto& t : read_robot_trials(c.folder.write(fmt::format("run_{}.csv", r), log_of(Pendulum{}, 500, r, 2e-4)),
                                     c.robot.scene.robot, {.columns = ""})) {
      for (double& phi : t.log.output[kAngle]) phi += zeros[r];
      auto told = std::make_shared<Commands>(*t.commands);
      for (double& phi : told->joint[0][kPhiRef]) phi += zeros[r];
      t.commands = told;
      c.trials.push_back(t);
    }
  }
  c.options.terms = robot_terms(c.robot, c.trials), c.options.terms.free = free;
  fit_per_run({zero}, c.trials, c.options);
  const RobotFit fit = fit_robot(c.robot, c.trials, c.options);
  REQUIRE(fit.converged);
  CHECK(fit.rms[kAngle] == Approx(2e-4).epsilon(0.1));
  for (std::size_t r = 0; r < zeros.size(); ++r)
    for (const auto& e : fit.parameters)
      if (e.name == fmt::format("{}@{}", zero, r + 1)) {
        CHECK(std::abs(e.value - zeros[r]) < 4 * *e.std);
        CHECK(*e.std < 1e-3);
      }
  CHECK(number_of(fit.robot, zero) == Approx(0.01).margin(2e-3));
}

TEST_CASE("how well a robot's constants are known is read with it, or not at all", "[driven]") {
  const Pendulum p;
  const test::Folder folder;
  const auto read = [&](const std::string& table) {
    return read_driven_robot(folder.write("robot.toml", robot_of(p, 1) + table)).known;
  };
  CHECK_FALSE(read(""));
  const auto known = read(
      "[identified]\norder = [\"robot.link.shank.mass\", \"command.delay\"]\n"
      "covariance = [[4e-4, 0], [0, 1e-8]]\noutputs = [\"phi_hip\"]\nrms = [0.01]\n");
  REQUIRE(known);
  CHECK(known->constants.order == std::vector<std::string>{"robot.link.shank.mass", "command.delay"});
  CHECK(known->constants.covariance(0, 0) == 4e-4);
  CHECK(known->rms == std::map<std::string, double>{{"phi_hip", 0.01}});
  const auto refused = [&](const std::string& table, const std::string& words) {
    CHECK_THROWS_WITH(read("[identified]\n" + table), Catch::Contains("robot.toml:") && Catch::Contains(words));
  };
  refused("order = [\"robot.link.tail.mass\"]\ncovariance = [[1]]\n", "robot.link.tail.mass");
  refused("order = [\"robot.link.shank.mass\"]\ncovariance = [[1, 0]]\n", "covariance");
  refused("order = [\"robot.link.shank.mass\"]\ncovariance = [[-1]]\n", "covariance");
  refused("order = [\"robot.link.shank.mass\"]\ncovariance = [[1]]\nverdict = 1\n", "verdict");
  refused("covariance = [[1]]\n", "order");
  const std::string mass = "order = [\"robot.link.shank.mass\"]\ncovariance = [[1]]\n";
  refused(mass + "outputs = [\"phi_toe\"]\nrms = [1]\n", "phi_toe");
  refused(mass + "outputs = [\"phi_hip\"]\n", "rms");
  refused(mass + "outputs = [\"phi_hip\"]\nrms = [0]\n", "above 0");
}

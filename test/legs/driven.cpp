// Trials of driven robots: a pendulum of two links is logged with noise, and its constants come back within their
// errors.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "landing/body/body_run.hpp"
#include "test/legs/pendulum.hpp"
#include "tools/study/baselines.hpp"
#include "tools/study/drop_residuals.hpp"
#include "tools/study/robot_trials.hpp"

using namespace ukemi;
using namespace ukemi::landing;
using namespace ukemi::tools;
using namespace legs;

namespace {

double truth(const Pendulum& p, const std::string& name) {
  const std::map<std::string, double> values = {{kFree[0], p.i1},
                                                {kFree[1], p.m2},
                                                {kFree[2], p.i2},
                                                {kFree[3], p.r2},
                                                {kFree[4], p.dry[0]},
                                                {kFree[5], p.dry[1]},
                                                {kFree[6], p.viscous[0]},
                                                {kFree[7], p.viscous[1]},
                                                {"command.hip.torque_gain", p.gain[0]},
                                                {"command.knee.torque_gain", p.gain[1]},
                                                {"command.delay", p.delay}};
  return values.at(name);
}

void check_within_errors(const Pendulum& p, const RobotFit& fit) {
  for (const auto& e : fit.parameters) {
    if (!e.free) continue;
    INFO(e.name << " " << e.value << ", true " << truth(p, e.name));
    REQUIRE(e.std);
    CHECK(std::abs(e.value - truth(p, e.name)) < 4 * *e.std);
    CHECK(*e.std < 0.05 * std::abs(e.value));
  }
}

}  // namespace

TEST_CASE("a driven robot moves as the textbook's pendulum does", "[driven]") {
  Pendulum p;
  p.delay = 0.0013, p.limit[0] = 1.5, p.limit[1] = 0.7;
  const Case c(p, 1, 1, 0, kFree, 0);
  DrivenRobot robot = c.robot;
  robot.path.delay = p.delay;
  const RobotTrial& t = c.trials[0];
  const DrivenStart start{{{0.1, 0, 0}, {-0.2, 0, 0}}};
  const DrivenRollout r = roll_driven(robot.scene.robot, robot.path, *t.commands, start, t.log.t);
  REQUIRE(r.complete);
  for (std::size_t j = 0; j < 2; ++j) {
    double worst = 0, limited = 0;
    for (std::size_t i = 0; i < t.log.t.size(); ++i) {
      worst = std::max(worst, std::abs(r.joint[j][kAngle][i] - t.log.output[kJointSignals * j + kAngle][i]));
      limited += std::abs(r.joint[j][kTorque][i]) == p.limit[j];
    }
    CHECK(worst < 2e-5);
    CHECK(limited > 20);  // rows at the level: it is reached
    CHECK(limited < 600);
  }
}

TEST_CASE("a driven robot that rubs takes the steps of one that does not, and sticks", "[driven]") {
  Pendulum p;
  for (double& friction : p.dry) friction *= 4;
  const Case c(p, 1, 1, 0, kFree, 0);
  const RobotTrial& t = c.trials[0];
  const DrivenStart start{{{0.1, 0, 0}, {-0.2, 0, 0}}};
  const auto rolled = [&](double step) {
    return roll_driven(c.robot.scene.robot, c.robot.path, *t.commands, start, t.log.t, {.step = step});
  };
  const DrivenRollout usual = rolled(0), exact = rolled(2e-5);
  double worst = 0, least = 1;
  long still = 0;
  for (std::size_t j = 0; j < 2; ++j)
    for (std::size_t i = 0; i < t.log.t.size(); ++i) {
      worst = std::max(worst, std::abs(usual.joint[j][kAngle][i] - exact.joint[j][kAngle][i]));
      if (const double rate = std::abs(exact.joint[j][kRate][i]); rate > 0) least = std::min(least, rate);
      still += exact.joint[j][kRate][i] == 0;
    }
  CAPTURE(worst, still, least);
  CHECK(worst < 1e-6);
  CHECK(still > 20);  // rows: it sticks, and does not creep
  Robot smooth = c.robot.scene.robot;
  for (Joint& j : smooth.joints) j.sea.friction = 0;
  CHECK(stable_step(c.robot.scene.robot, c.robot.path, *t.commands, start) ==
        stable_step(smooth, c.robot.path, *t.commands, start));
}

TEST_CASE("constants of a driven robot come back within their errors", "[driven]") {
  Pendulum p;
  SECTION("from whole logs") {
    const Case c(p, 1.15, 2, 0, kFree);
    const RobotFit fit = fit_robot(c.robot, c.trials, c.options);
    REQUIRE(fit.converged);
    check_within_errors(p, fit);
    CHECK(fit.trusted());
    CHECK(fit.robot.scene.robot.links[1].mass == Approx(p.m2).epsilon(0.02));
    CHECK(fit.rms[kAngle] == Approx(2e-4).epsilon(0.1));
  }
  SECTION("from pieces, with a delay, gains and levels of the torque") {
    p.gain[0] = 1.1, p.gain[1] = 0.92, p.delay = 0.0017, p.limit[0] = 2.5, p.limit[1] = 1.1;
    std::vector<std::string> free = kFree;
    free.erase(free.begin() + 1);
    for (const char* more : {"command.hip.torque_gain", "command.knee.torque_gain", "command.delay"})
      free.push_back(more);
    Pendulum known = p;
    Case c(p, 1, 2, 1, free);
    CHECK(c.trials.size() == 6);
    const RobotFit fit = fit_robot(c.robot, c.trials, c.options);
    REQUIRE(fit.converged);
    check_within_errors(known, fit);
  }
}

TEST_CASE("errors of what is not fitted count in the errors of a driven robot's constants", "[driven]") {
  const Pendulum p;
  const std::string known = "robot.link.thigh.com.along";
  constexpr double kError = 0.001;  // [m]
  Case c(p, 1, 2, 0, kFree);
  const RobotFit exact = fit_robot(c.robot, c.trials, c.options);
  c.options.errors = {{known, kError}};
  const RobotFit fit = fit_robot(c.robot, c.trials, c.options);
  REQUIRE(fit.converged);
  REQUIRE(fit.considered.size() == 1);
  // What a constant does where the other is off by its error: a fit of the robot that is.
  DrivenRobot off = c.robot;
  off.scene.robot.links[0].com.along += kError;
  c.options.errors.clear();
  const RobotFit moved = fit_robot(off, c.trials, c.options);
  REQUIRE(moved.converged);
  double largest = 0;
  for (std::size_t i = 0; i < fit.fitted.size(); ++i) {
    const identify::Estimate &a = *exact.globals()[i], &b = *fit.globals()[i], &m = *moved.globals()[i];
    const double shift = fit.considered[0].shift(long(i), 0);
    INFO(a.name << " " << a.value << " +- " << *a.std << ", +- " << *b.std << ", shift " << shift << ", " << m.value);
    CHECK(std::abs(m.value - a.value - shift) < 0.05 * std::abs(shift) + 0.1 * *a.std);
    CHECK(*b.std == Approx(std::hypot(*a.std, shift)).epsilon(1e-3));
    CHECK(*b.std_noise == Approx(*a.std).epsilon(1e-3));
    largest = std::max(largest, std::abs(shift) / *a.std);
  }
  CHECK(largest > 2);  // it is what makes most of some error
  for (const identify::ErrorBudget& b : identify::error_budget(fit))
    CHECK(b.shares[0].second + b.shares[1].second == Approx(1));
  c.options.errors = {{kFree[0], 0.01}};
  CHECK_THROWS_WITH(c.options.validate(), Catch::Matchers::Contains("--prior says what is known of it"));
}

TEST_CASE("the profile likelihood of a driven robot's constants: as wide as their errors where these are small",
          "[driven]") {
  const Pendulum p;
  Case c(p, 1.1, 1, 0, {kFree[1], kFree[5], kFree[7]});
  c.options.profiles = {kFree[1], kFree[5]};
  const RobotFit fit = fit_robot(c.robot, c.trials, c.options);
  REQUIRE(fit.converged);
  REQUIRE(fit.profiles.size() == 2);
  for (const identify::Profile& profile : fit.profiles) {
    INFO(profile.constant);
    const auto e = std::find_if(fit.parameters.begin(), fit.parameters.end(),
                                [&](const auto& x) { return x.name == profile.constant; });
    REQUIRE(profile.low);
    REQUIRE(profile.high);
    CHECK(*profile.low == Approx(e->ci_low).margin(0.1 * e->half_width()));
    CHECK(*profile.high == Approx(e->ci_high).margin(0.1 * e->half_width()));
    const std::size_t middle = profile.rise.size() / 2;
    CHECK(profile.rise[middle] == 0);
    CHECK(std::is_sorted(profile.rise.begin() + long(middle), profile.rise.end()));
    CHECK(std::is_sorted(profile.rise.rbegin() + long(middle), profile.rise.rend()));
  }
  c.options.profiles = {kFree[0]};
  CHECK_THROWS_WITH(fit_robot(c.robot, c.trials, c.options),
                    Catch::Matchers::Contains("not among the --free constants"));
}

TEST_CASE("a term that a driven robot lacks is asked for, and nothing is trusted then", "[driven]") {
  Pendulum p;
  p.delay = 0.002;
  const Case c(p, 1, 2, 0, {kFree[4], kFree[5]});
  const RobotFit fit = fit_robot(c.robot, c.trials, c.options);
  CHECK(fit.tests.model_rejected());
  CHECK_FALSE(fit.trusted());
  for (const auto& e : fit.parameters) CHECK(e.verdict != identify::Identifiability::kTrusted);
  REQUIRE(fit.tests.missing());
  CHECK(fit.tests.missing()->term == "command.delay");
  CHECK(fit.tests.missing()->size == Approx(p.delay).epsilon(0.2));
}

TEST_CASE("differences of a driven rollout are its derivatives", "[driven]") {
  const Pendulum p;
  const Case c(p, 1, 1, 0, kFree);
  const auto slopes = [&](double step) {
    RobotFitOptions o = c.options;
    o.difference = step;
    const RobotTrials simulator(c.robot, c.trials, o);
    Settings settings;
    for (const char* name : {"command.delay", "robot.link.shank.mass", "drive.knee.friction", "drive.hip.i_motor"})
      settings.push_back(
          {&o.terms[name], std::string(name) == "command.delay" ? 1e-3 : simulator.value(o.terms[name])});
    settings.push_back({&o.terms["start.knee.dphi"], 0.05});
    FollowedDrop d = simulator.follow(0, settings, c.trials[0].log.t, {});
    REQUIRE(simulator.differentiate(0, settings, c.trials[0].log.t, {}, d));
    return d.slope[kJointSignals + kAngle];
  };
  const Eigen::MatrixXd used = slopes(c.options.difference), finer = slopes(c.options.difference / 4);
  for (long k = 0; k < used.cols(); ++k) CHECK((used.col(k) - finer.col(k)).norm() < 1e-4 * finer.col(k).norm());
}

TEST_CASE("a prediction fits nothing but the starts", "[driven]") {
  const Pendulum p;
  const Case c(p, 1, 1, 0, kFree);
  const RobotFit right = predict_robot(c.robot, c.trials, c.options);
  REQUIRE(right.converged);
  CHECK(right.nuisance.size() == 4);
  CHECK(right.rms[kAngle] == Approx(2e-4).epsilon(0.1));
  Pendulum heavy = p;
  heavy.m2 *= 1.05;
  const Case wrong(heavy, 1, 1, 0, kFree);
  CHECK(predict_robot(c.robot, wrong.trials, c.options).rms[kAngle] > 1e-3);
}

TEST_CASE("a controller in the loop acts by the state at its row, a delay later", "[driven]") {
  Pendulum p;
  p.k_p = p.k_d = 0, p.delay = 0.0013;
  const auto law = [](double t, const double* phi, const double* dphi, double* torque) {
    torque[0] = 5 * (0.5 * std::sin(4 * t) - phi[0]) - 0.2 * dphi[0];
    torque[1] = 3 * (0.7 * std::sin(6 * t) - phi[1]) - 0.1 * dphi[1] + 0.2 * phi[0];
  };
  const Case c(p, 1, 1, 0, kFree, 0);
  DrivenRobot robot = c.robot;
  robot.path.delay = p.delay;
  Commands commands;
  commands.joint.resize(2);
  constexpr int kRows = 400;
  std::vector<std::array<double, 2>> truth;
  Pendulum::State y{0.1, -0.2, 0, 0};
  const double still[2] = {0, 0};
  double acts[2];
  law(0, &y[0], &y[2], acts);
  for (int k = 0; k < kRows; ++k) {
    commands.t.push_back(0.004 * k), truth.push_back({y[0], y[1]});
    double next[2];
    law(0.004 * k, &y[0], &y[2], next);
    p.advance(y, still, acts, p.delay);
    p.advance(y, still, next, 0.004 - p.delay);
    std::copy(next, next + 2, acts);
  }
  commands.controller = [&](double t, auto phi, auto dphi, auto torque) {
    law(t, phi.data(), dphi.data(), torque.data());
  };
  const DrivenRollout r =
      roll_driven(robot.scene.robot, robot.path, commands, {{{0.1, 0, 0}, {-0.2, 0, 0}}}, commands.t);
  REQUIRE(r.complete);
  for (std::size_t k = 0; k < kRows; ++k)
    for (std::size_t j = 0; j < 2; ++j) CHECK(r.joint[j][kAngle][k] == Approx(truth[k][j]).margin(5e-5));
}

namespace {

/// A landing with its joints held, by the run of a landing: another integrator (eighth order, steps of its own), events
/// on the dense output; and what a log of it tells the drives.
struct HeldLanding {
  static constexpr double kRate = 500;  // [Hz]
  BodyScene scene;
  BodyLanding landing;
  Commands commands;
  CommandPath path;
  DrivenStart start;
  std::vector<double> times;
  std::vector<const BodySample*> rows;

  explicit HeldLanding(const std::string& name) : scene(read_body_scene(UKEMI_DATASETS "/scenes/" + name + ".toml")) {
    const Robot& robot = scene.robot;
    const BodyMotion held = held_posture(scene);
    landing = simulate(scene, held, {.accuracy = 1e-10}, kRate);
    start.height = scene.drop.height;
    start.pitch = scene.drop.pitch, start.forward_speed = robot.base == Base::kFree ? scene.drop.forward_speed : 0;
    commands.t = {0, 10};
    for (std::size_t i = 0; i < robot.joints.size(); ++i) {
      const double most = robot.joints[i].kind == DriveKind::kGeared ? robot.joints[i].sea.tau_max : 1e9;
      commands.joint.emplace_back();
      commands.joint.back()[kPhiRef] = {held[i].phi_i, held[i].phi_i};
      commands.joint.back()[kDphiRef] = {0, 0};
      start.joint.push_back({held[i].phi_i, 0, 0});
      path.joints.push_back({.torque_low = -most, .torque_high = most});
    }
    for (const BodySample& row : landing.trajectory)
      if (times.empty() || row.t > times.back() + 1e-4) times.push_back(row.t), rows.push_back(&row);
  }
  /// What an accelerometer at the point that counts reads along and across its link.
  std::array<double, 2> specific_force(const BodySample& row) const {
    const double pitch = row.theta[std::size_t(scene.robot.peak_link)], s = std::sin(pitch), c = std::cos(pitch);
    const double x = row.acc_x, y = row.acc_y + scene.robot.gravity;
    return {x * s - y * c, x * c + y * s};
  }
  /// Not at an event, where accelerations jump.
  bool is_smooth(const DrivenRollout& r, double t) const {
    const bool on_grid = std::abs(t * kRate - std::round(t * kRate)) < 1e-6;
    return on_grid &&
           std::none_of(r.changes.begin(), r.changes.end(), [&](auto& c) { return std::abs(c.t - t) < 1e-3; });
  }
};

}  // namespace

TEST_CASE("a leg that follows a log's commands lands as the landing of the same reference does", "[driven]") {
  const HeldLanding held("hopper");
  REQUIRE(held.landing.touches.size() >= 2);
  const auto worst = [&](double step) {
    const DrivenRollout r =
        roll_driven(held.scene.robot, held.path, held.commands, held.start, held.times, {.step = step, .loads = true});
    REQUIRE(r.complete);
    double out = 0;
    for (std::size_t j = 0; j < held.scene.robot.joints.size(); ++j)
      for (std::size_t k = 0; k < held.times.size(); ++k)
        out = std::max(out, std::abs(r.joint[j][kAngle][k] - held.rows[k]->phi[j]));
    REQUIRE(r.changes.size() >= 2);
    CHECK(r.changes[0].touches);
    CHECK(r.changes[0].contact == held.landing.touches[0].point);
    CHECK(r.changes[0].t == Approx(held.landing.contacts.first()).margin(1e-5));
    for (std::size_t k = 0; k < held.times.size(); ++k) {
      if (!held.is_smooth(r, held.times[k])) continue;
      CHECK(r.acceleration[kAcross][k] == Approx(held.rows[k]->acc_y).margin(0.01));
      for (std::size_t c = 0; c < held.scene.robot.contacts.size(); ++c)
        CHECK(r.force[c][1][k] == Approx(held.rows[k]->force_y[c]).margin(0.05));
    }
    return out;
  };
  const double coarse = worst(2e-4), fine = worst(5e-5);
  INFO("coarse " << coarse << ", fine " << fine);
  CHECK(coarse < 1e-5);
  CHECK(fine < 1e-7);
}

TEST_CASE("a thrown robot that follows a log's commands lands as the landing of the same reference does", "[driven]") {
  const HeldLanding held("foot");
  const Robot& robot = held.scene.robot;
  const DrivenRollout r =
      roll_driven(robot, held.path, held.commands, held.start, held.times, {.step = 2e-5, .loads = true});
  REQUIRE(r.complete);
  for (std::size_t k = 0; k < held.times.size(); ++k) {
    const BodySample& row = *held.rows[k];
    INFO("at " << row.t << " s");
    CHECK(r.base[kPitch][k] == Approx(row.theta[0]).margin(1e-5));
    CHECK(r.base[kOriginX][k] - r.base[kOriginX][0] == Approx(row.x[0] - held.rows[0]->x[0]).margin(1e-5));
    CHECK(r.base[kOriginY][k] == Approx(row.y[0]).margin(1e-5));
    for (std::size_t j = 0; j < robot.joints.size(); ++j)
      CHECK(r.joint[j][kAngle][k] == Approx(row.phi[j]).margin(1e-5));
    if (!held.is_smooth(r, row.t)) continue;
    CHECK(r.acceleration[kAlong][k] == Approx(row.acc_x).margin(0.1));
    CHECK(r.acceleration[kAcross][k] == Approx(row.acc_y).margin(0.1));
    const auto [along, across] = held.specific_force(row);
    CHECK(r.acceleration[kSpecificAlong][k] == Approx(along).margin(0.1));
    CHECK(r.acceleration[kSpecificAcross][k] == Approx(across).margin(0.1));
  }
}

TEST_CASE("constants of a thrown robot come back from its accelerometer, its pitch and its joints", "[driven]") {
  const HeldLanding held("three_links");
  const test::Folder folder;
  Random random(kSeed, 77);
  std::string log = "t", rows;
  for (const Joint& j : held.scene.robot.joints) log += fmt::format(",phi_{0},phi_ref_{0},dphi_ref_{0}", j.name);
  log += fmt::format(",theta_{},sf_along,sf_across\n", held.scene.robot.links[0].name);
  for (const BodySample* row : held.rows) {
    log += fmt::format("{:.9g}", row->t);
    for (std::size_t j = 0; j < held.scene.robot.joints.size(); ++j)
      log += fmt::format(",{:.9g},{:.17g},0", row->phi[j] + 3e-4 * random.normal(), held.commands.joint[j][kPhiRef][0]);
    const auto [along, across] = held.specific_force(*row);
    log += fmt::format(",{:.9g},{:.9g},{:.9g}\n", row->theta[0] + 3e-4 * random.normal(), along + 0.2 * random.normal(),
                       across + 0.2 * random.normal());
  }
  DrivenRobot robot{.scene = held.scene, .path = held.path};
  std::map<std::string, double> truth;
  const std::string foot = "robot.contact." + held.scene.robot.contacts.back().name + ".";
  for (const std::string& name : {foot + "stiffness", foot + "damping_normal", std::string("drive.knee.k_sea")})
    truth[name] = number_of(robot, name);
  const auto trials = read_robot_trials(folder.write("fall.csv", log), held.scene.robot, {.columns = ""});
  RobotFitOptions options;
  options.terms = robot_terms(robot, trials), options.threads = 2;
  for (const auto& [name, value] : truth)
    options.terms.free.push_back(name), set_in(robot, options.terms[name], 1.15 * value);
  const RobotFit fit = fit_robot(robot, trials, options);
  INFO(fit.message);
  REQUIRE(fit.converged);
  for (const identify::Estimate& e : fit.parameters) {
    if (!e.free) continue;
    INFO(e.name << " " << e.value << ", true " << truth.at(e.name));
    REQUIRE(e.std);
    CHECK(std::abs(e.value - truth.at(e.name)) < 4 * *e.std);
    CHECK(*e.std < 0.1 * e.value);
  }
}

TEST_CASE("a log of an encoder's steps has at least the noise of its steps", "[driven]") {
  const Pendulum p;
  Case c(p, 1, 1, 0, kFree, 0);
  constexpr double kStep = 0.03;  // coarse: most rows repeat the one before
  for (double& x : c.trials[0].log.output[kAngle]) x = kStep * std::round(x / kStep);
  const RobotTrials trials(c.robot, c.trials, c.options);
  CHECK(noise_of(trials)[kAngle] >= kStep / std::sqrt(12.0) * (1 - 1e-6));
  CHECK(noise_of(trials)[kJointSignals + kAngle] < 1e-4);
}

TEST_CASE("what commands pass through stands with the robot, and a scene that names one has no effect", "[driven]") {
  const test::Folder folder;
  std::string scene = test::read(UKEMI_DATASETS "/scenes/hopper.toml");
  const std::string from = "../robots/hopper.toml";
  scene.replace(scene.rfind(from), from.size(), UKEMI_DATASETS "/robots/hopper.toml");
  CHECK_NOTHROW(read_body_scene(folder.write("scene.toml", scene)));
  CHECK_THROWS_WITH(read_body_scene(folder.write("scene.toml", scene + "\n[command]\nrows = 1\n")),
                    Catch::Contains("command"));
}

TEST_CASE("a log is cut at given times, and what is outside of them is left out", "[driven]") {
  const Pendulum p;
  const Case c(p, 1, 1, 0, kFree, 0);
  const std::string log = c.folder.write("cut.csv", log_of(p, 750, 0, 0));
  const auto trials = read_robot_trials(log, c.robot.scene.robot, {.times = {0.4, 1.0, 1.7}});
  REQUIRE(trials.size() == 2);
  CHECK(trials[0].origin == Approx(0.4));
  CHECK(trials[1].origin == Approx(1.0));
  CHECK(trials[0].log.t.size() == 150);
  CHECK(trials[1].log.t.size() == 175);
  CHECK_THROWS_WITH(read_robot_trials(log, c.robot.scene.robot, {.times = {5, 6}}), Catch::Contains("fewer than"));
}

TEST_CASE("a run of hops is cut where the leg pushes, not where it stretches in the air", "[driven]") {
  // Each 0.5 s the leg extends under torque, then, without any, bends and stretches once more.
  const DrivenRobot robot = read_driven_robot(UKEMI_DATASETS "/scenes/hopper.toml");
  std::string text = "t,phi_hip,phi_knee,torque_hip,torque_knee\n";
  constexpr double kPi = 3.14159265358979;
  for (int i = 0; i < 1100; ++i) {
    const double t = i * 2e-3, s = std::fmod(t, 0.5) / 0.5, bent = 0.5 + 0.5 * std::cos(4 * kPi * s);
    const bool pushes = s > 0.05 && s < 0.25;
    text += fmt::format("{},{},{},0,{}\n", t, bent, -2 * bent, pushes ? 5 : 0);
  }
  const test::Folder folder;
  const std::string log = folder.write("hops.csv", text);
  const auto trials = read_robot_trials(log, robot.scene.robot, {.columns = "", .cuts = RobotLogOptions::Cuts::kHops});
  REQUIRE(trials.size() == 4);
  for (const RobotTrial& t : trials) {
    CHECK(std::fmod(t.origin, 0.5) == Approx(0.5 * 0.15).margin(0.03));
    CHECK(t.log.t.size() == 250);
  }
  const auto tied =
      read_robot_trials(log, robot.scene.robot, {.columns = "", .cuts = RobotLogOptions::Cuts::kHops, .tied = 3});
  REQUIRE(tied.size() == 2);  // three hops, and the one that is left
  CHECK(tied[0].log.t.size() == 750);
  CHECK(tied[1].origin == trials[3].origin);
  const Pendulum p;
  const Case pinned(p, 1, 1, 0, kFree, 0);
  CHECK_THROWS_WITH(read_robot_trials(pinned.folder.write("pinned.csv", log_of(p, 750, 0, 0)), pinned.robot.scene.robot,
                                      {.columns = "", .cuts = RobotLogOptions::Cuts::kHops}),
                    Catch::Contains("base = \"rail\" is needed"));
}

TEST_CASE("a centre of mass stays within its link", "[driven]") {
  const Pendulum p;
  const Case c(p, 1, 1, 0, kFree);
  const auto bounds = [](const DrivenRobot& robot, const std::string& name) {
    const DropTerm t = robot_terms(robot, {})["robot.link." + name];
    return std::array{t.lower, t.upper};
  };
  CHECK(bounds(c.robot, "thigh.com.along") == std::array{0.0, p.l1});  // its child's joint
  CHECK(bounds(c.robot, "shank.com.along") == std::array{0.0, 0.25});  // the point that counts
  CHECK(bounds(c.robot, "shank.com.across")[1] == Approx(0.25 / 4));
  CHECK(bounds(c.robot, "shank.com.across")[0] == Approx(-0.25 / 4));
  // The point that counts is its centre of mass, where none is given; a push is a place.
  DrivenRobot arm = read_driven_robot(UKEMI_DATASETS "/robots/one_link.toml");
  CHECK(bounds(arm, "arm.com.along") == std::array{0.0, 0.3});
  arm.scene.robot.pushes.clear();
  CHECK(bounds(arm, "arm.com.along") == std::array{-1.0, 1.0});  // of no length that is known
}

TEST_CASE("a prediction stands beside what knows no physics", "[driven]") {
  const Pendulum p;
  Case c(p, 1, 4, 0, kFree);
  const RobotFit right = predict_robot(c.robot, c.trials, c.options);
  for (const std::size_t channel : {std::size_t(kAngle), std::size_t(kJointSignals + kAngle)}) {
    const Baseline b = baselines(right, logs_of(c.trials))[channel];
    REQUIRE(b.known());
    CHECK(b.beaten());
    CHECK(b.model < 3e-4);
    CHECK(b.held > 0.01);
    CHECK(b.mean > 0.01);
  }
  // The same trial over and over: its mean knows all.
  for (RobotTrial& t : c.trials)
    t.log = c.trials[0].log, t.origin = c.trials[0].origin, t.commands = c.trials[0].commands;
  const Baseline same = baselines(predict_robot(c.robot, c.trials, c.options), logs_of(c.trials))[kAngle];
  CHECK(same.mean < 1e-12);
  CHECK_FALSE(same.beaten());
  const Case two(p, 1, 2, 0, kFree);
  CHECK(std::isnan(baselines(predict_robot(two.robot, two.trials, two.options), logs_of(two.trials))[kAngle].mean));
}

namespace {

/// The k-th robot that the page of measured robots gives.
std::string robot_of_the_page(int k) {
  const std::string page = test::read(UKEMI_SOURCE "/tools/docs/measured.md"), open = "```toml\n";
  std::size_t at = 0;
  for (; k >= 0; --k) at = page.find(open, at) + open.size();
  return page.substr(at, page.find("```", at) - at);
}

}  // namespace

TEST_CASE("measured: a double pendulum hangs at zero, and its torques turn its angles up", "[driven]") {
  const auto log = test::lab_file("double_pendulum/20230629-143524.csv");
  if (!log) return;
  const test::Folder folder;
  const DrivenRobot robot = read_driven_robot(folder.write("robot.toml", robot_of_the_page(0)));
  const auto residual = [&](const char* shoulder, const char* elbow) {
    const auto trials = read_robot_trials(
        *log, robot.scene.robot,
        {.columns = fmt::format("t=time,phi_shoulder=pos_meas1,phi_elbow=pos_meas2,torque_ff_shoulder={}tau_con1,"
                                "torque_ff_elbow={}tau_con2",
                                shoulder, elbow)});
    RobotFitOptions options;
    options.terms = robot_terms(robot, trials), options.threads = 2;
    const RobotFit fit = predict_robot(robot, trials, options);
    return std::array{fit.rms[kAngle], fit.rms[kJointSignals + kAngle]};
  };
  const auto right = residual("", ""), turned = residual("", "-1*");
  CHECK(right[0] == Approx(0.101).epsilon(0.1));
  CHECK(right[1] == Approx(0.212).epsilon(0.1));
  for (std::size_t j = 0; j < 2; ++j) CHECK(turned[j] > 2 * right[j]);
}

TEST_CASE("measured: a leg's push, flight and landing are followed from a first guess", "[driven]") {
  const auto log = test::lab_file("hopping_leg/run_b.csv");
  if (!log) return;
  const test::Folder folder;
  const DrivenRobot robot = read_driven_robot(folder.write("robot.toml", robot_of_the_page(2)));
  std::string columns = "t=t";
  for (const std::string joint : {"hip", "knee"})
    for (const auto& [ours, theirs] :
         std::initializer_list<std::pair<const char*, std::string>>{{"phi", "q_" + joint},
                                                                    {"dphi", "v_" + joint},
                                                                    {"torque", "tau_" + joint},
                                                                    {"phi_ref", "qd_" + joint},
                                                                    {"dphi_ref", "vd_" + joint},
                                                                    {"torque_ff", "ff_" + joint},
                                                                    {"k_p", "kp"},
                                                                    {"k_d", "kd"}})
      columns += fmt::format(",{}_{}={}", ours, joint, theirs);
  CHECK(read_robot_trials(*log, robot.scene.robot, {.columns = columns, .cuts = RobotLogOptions::Cuts::kHops}).size() ==
        10);  // 11 pushes
  const auto trials = read_robot_trials(*log, robot.scene.robot, {.columns = columns, .times = {0.76735, 1.44294}});
  REQUIRE(trials.size() == 1);
  RobotFitOptions options;
  options.terms = robot_terms(robot, trials), options.threads = 2;
  const RobotFit first = predict_robot(robot, trials, options);
  options.terms.free = {
      "command.hip.torque_gain",      "command.knee.torque_gain",         "drive.hip.i_motor",
      "drive.knee.i_motor",           "drive.hip.viscous_friction",       "robot.contact.foot.friction",
      "robot.contact.stop.stiffness", "robot.contact.stop.damping_normal"};
  const RobotFit fit = fit_robot(robot, trials, options);
  INFO(first.rms[kAngle] << " " << first.rms[kJointSignals + kAngle] << ", fitted " << fit.rms[kAngle] << " "
                         << fit.rms[kJointSignals + kAngle]);
  CHECK(fit.rms[kAngle] < 0.03);
  CHECK(fit.rms[kJointSignals + kAngle] < 0.03);
  CHECK_FALSE(fit.trusted());
}

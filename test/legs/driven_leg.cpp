// A leg of three driven joints on a rail, with friction, a delay and noise, simulated here by equations of our own, and
// its constants fitted to the logs. With UKEMI_DRAWS=30 the draws of issue 40.
#include <fmt/format.h>

#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>

#include "common/random.hpp"
#include "test/folder.hpp"
#include "test/impact.hpp"
#include "tools/study/contact_times.hpp"
#include "tools/study/robot_trials.hpp"

using namespace ukemi;
using namespace ukemi::landing;
using namespace ukemi::tools;

namespace {

constexpr std::uint64_t kSeed = 20261127;
constexpr int kLinks = 3;
constexpr double kRow = 2e-3, kGravity = 9.81;

/// Slider, thigh, shank, foot: coordinates are the height s of the hip and the absolute angles of the links, each 0
/// hanging straight down. Kane's way: M = sum_i m_i J_i' J_i + ..., with the Jacobian of every centre of mass.
struct Leg {
  double slider = 0.9;
  std::array<double, kLinks> mass{1.2, 0.5, 0.2}, length{0.2, 0.2, 0.1}, com{0.08, 0.09, 0.05},
      inertia{4e-3, 2e-3, 3e-4}, armature{6e-3, 5e-3, 3e-3}, dry{0.15, 0.12, 0.06}, viscous{0.02, 0.015, 0.01};
  double rail_viscous = 3, rail_dry = 1.5;
  double k = 9000, c = 60, k_t = 9000, c_t = 40, mu = 0.8;
  double delay = 0.6e-3;

  static constexpr double kP = 40, kD = 1.2;
  using Vector = Eigen::Matrix<double, 1 + kLinks, 1>;
  struct State {
    Vector q, v;
    double slip = 0;
    bool touches = false;
  };

  /// d(point)/dq of a place `far` along link n.
  Eigen::Matrix<double, 2, 1 + kLinks> jacobian(const Vector& q, int n, double far) const {
    Eigen::Matrix<double, 2, 1 + kLinks> j = Eigen::Matrix<double, 2, 1 + kLinks>::Zero();
    j(1, 0) = 1;
    for (int i = 0; i <= n; ++i) {
      const double arm = i < n ? length[std::size_t(i)] : far;
      j(0, 1 + i) = arm * std::cos(q[1 + i]), j(1, 1 + i) = arm * std::sin(q[1 + i]);
    }
    return j;
  }
  double toe_height(const Vector& q) const {
    double y = q[0];
    for (int i = 0; i < kLinks; ++i) y -= length[std::size_t(i)] * std::cos(q[1 + i]);
    return y;
  }
  std::array<double, kLinks> angles(const Vector& x) const { return {x[1], x[2] - x[1], x[3] - x[2]}; }

  std::array<double, kLinks> asked(const State& s, const std::array<double, kLinks>& ref) const {
    const auto phi = angles(s.q), rate = angles(s.v);
    std::array<double, kLinks> out;
    for (std::size_t i = 0; i < kLinks; ++i) out[i] = kP * (ref[i] - phi[i]) - kD * rate[i];
    return out;
  }
  /// dv, the slip's rate, and the floor's force on the toe, along and across it.
  Vector acceleration(const State& s, const std::array<double, kLinks>& ref, double& dslip,
                      Eigen::Vector2d* floor = nullptr) const {
    Eigen::Matrix<double, 1 + kLinks, 1 + kLinks> m = Eigen::Matrix<double, 1 + kLinks, 1 + kLinks>::Zero();
    Vector force = Vector::Zero();
    m(0, 0) = slider, force[0] = -slider * kGravity;
    for (int i = 0; i < kLinks; ++i) {
      const auto j = jacobian(s.q, i, com[std::size_t(i)]);
      const double mi = mass[std::size_t(i)];
      m += mi * j.transpose() * j, m(1 + i, 1 + i) += inertia[std::size_t(i)];
      Eigen::Vector2d turning(0, -kGravity);  // gravity, and what the angles' rates do
      for (int part = 0; part <= i; ++part) {
        const double arm = part < i ? length[std::size_t(part)] : com[std::size_t(i)],
                     w = s.v[1 + part] * s.v[1 + part];
        turning -= arm * w * Eigen::Vector2d(-std::sin(s.q[1 + part]), std::cos(s.q[1 + part]));
      }
      force += mi * j.transpose() * turning;
    }
    const auto rate = angles(s.v), drive = asked(s, ref);
    const auto smooth = [](double v) { return v / std::hypot(v, 2e-4); };
    for (int i = 0; i < kLinks; ++i) {
      const std::size_t n = std::size_t(i);
      const double tau = drive[n] - dry[n] * smooth(rate[n]) - viscous[n] * rate[n];
      force[1 + i] += tau, m(1 + i, 1 + i) += armature[n];
      if (i == 0) continue;
      force[i] -= tau, m(i, i) += armature[n], m(i, 1 + i) -= armature[n], m(1 + i, i) -= armature[n];
    }
    force[0] -= rail_viscous * s.v[0] + rail_dry * smooth(s.v[0]);
    dslip = 0;
    if (s.touches) {
      const auto j = jacobian(s.q, kLinks - 1, length[kLinks - 1]);
      const Eigen::Vector2d rate_of_toe = j * s.v;
      const double push = std::max(0.0, -k * toe_height(s.q) - c * rate_of_toe[1]),
                   held = k_t * s.slip + c_t * rate_of_toe[0], along = std::clamp(held, -mu * push, mu * push);
      dslip = std::abs(held) <= mu * push ? rate_of_toe[0] : (along - k_t * s.slip) / c_t;
      force += j.transpose() * Eigen::Vector2d(-along, push);
      if (floor) *floor = {-along, push};
    }
    return m.ldlt().solve(force);
  }
  /// By Heun's method, in steps of 2 us.
  void advance(State& s, const std::array<double, kLinks>& ref, double seconds) const {
    const int n = std::max(1, int(std::lround(seconds / 2e-6)));
    const double h = seconds / n;
    for (int i = 0; i < n; ++i) {
      const bool below = toe_height(s.q) < 0;
      if (below != s.touches) s.touches = below, s.slip = 0;
      double ds, es;
      const Vector a = acceleration(s, ref, ds);
      State t = s;
      t.q += h * s.v, t.v += h * a, t.slip += h * ds;
      const Vector b = acceleration(t, ref, es);
      s.q += 0.5 * h * (s.v + t.v), s.v += 0.5 * h * (a + b), s.slip += 0.5 * h * (ds + es);
    }
  }
};

std::array<double, kLinks> reference(double t, double phase) {
  return {0.5 + 0.35 * std::sin(9 * t + phase), -1.1 + 0.5 * std::sin(11 * t + 2 * phase) + 0.2 * std::sin(31 * t),
          0.7 + 0.3 * std::sin(13 * t + 3 * phase)};
}

/// A log that begins with the toe at rest on the floor; with `loads` of the slider's accelerometer and a force plate
/// too; `reported`: what the columns of reported torques are called.
std::string log_of(const Leg& leg, int rows, double phase, std::uint64_t draw, bool loads = false,
                   const std::string& reported = "torque") {
  Random random(kSeed, draw);
  std::string out = fmt::format(
      "t,phi_hip,phi_knee,phi_ankle,{0}_hip,{0}_knee,{0}_ankle,phi_ref_hip,phi_ref_knee,phi_ref_ankle", reported);
  out += loads ? ",ay,f_toe_x,f_toe_y\n" : "\n";
  Leg::State s;
  const auto first = reference(0, phase);
  s.v.setZero(), s.q << 0, first[0], first[0] + first[1], first[0] + first[1] + first[2];
  s.q[0] = -leg.toe_height(s.q);
  auto in_force = first;
  for (int k = 0; k < rows; ++k) {
    const auto ref = reference(kRow * k, phase);
    const auto phi = leg.angles(s.q), torque = leg.asked(s, in_force);
    out += fmt::format("{}", kRow * k);
    for (const double x : phi) out += fmt::format(",{:.9g}", x + 5e-4 * random.normal());
    for (const double x : torque) out += fmt::format(",{:.9g}", x + 0.02 * random.normal());
    for (const double x : ref) out += fmt::format(",{:.17g}", x);
    if (loads) {
      double slip;
      Eigen::Vector2d floor(0, 0);
      const double up = leg.acceleration(s, in_force, slip, &floor)[0];
      out += fmt::format(",{:.9g},{:.9g},{:.9g}", up + 0.05 * random.normal(), floor[0] + 0.1 * random.normal(),
                         floor[1] + 0.1 * random.normal());
    }
    out += "\n";
    leg.advance(s, in_force, leg.delay);
    leg.advance(s, ref, kRow - leg.delay);
    in_force = ref;
  }
  return out;
}

/// Its file, the fitted constants off by `off`.
std::string robot_of(const Leg& leg, double off) {
  const char *links[] = {"thigh", "shank", "foot"}, *joints[] = {"hip", "knee", "ankle"};
  std::string out = fmt::format(
      "[robot]\ngravity = 9.81\nbase = \"rail\"\nrail = {{ direction_deg = 90, viscous = {}, friction = {} }}\n"
      "peak = {{ link = \"slider\", at = [0, 0] }}\n[[robot.link]]\nname = \"slider\"\nmass = {}\ninertia_com = 1e-3\n",
      leg.rail_viscous * off, leg.rail_dry / off, leg.slider);
  for (std::size_t i = 0; i < kLinks; ++i)
    out += fmt::format(
        "[[robot.link]]\nname = \"{}\"\nparent = \"{}\"\njoint = \"{}\"\nat = [{}, 0]\nmass = {}\ninertia_com = {}\n"
        "com = [{}, 0]\n",
        links[i], i == 0 ? "slider" : links[i - 1], joints[i], i == 0 ? 0 : leg.length[i - 1],
        i == 1 ? leg.mass[i] * off : leg.mass[i], leg.inertia[i], leg.com[i]);
  out += fmt::format(
      "[[robot.contact]]\nname = \"toe\"\nlink = \"foot\"\nat = [{}, 0]\nstiffness = {}\ndamping_normal = {}\n"
      "damping_tangential = {}\nstiffness_tangential = {}\nfriction = {}\n",
      leg.length[2], leg.k * off, leg.c * off, leg.c_t, leg.k_t, leg.mu / off);
  for (std::size_t i = 0; i < kLinks; ++i)
    out += fmt::format(
        "[drive.{}]\nkind = \"geared\"\nk_p = {}\nk_d = {}\ni_motor = {}\nfriction = {}\nviscous_friction = {}\n",
        joints[i], Leg::kP, Leg::kD, leg.armature[i], i == 2 ? leg.dry[i] : leg.dry[i] * off,
        i == 2 ? leg.viscous[i] : leg.viscous[i] / off);
  return out + "[command]\ndelay = 0.0003\n";
}

std::map<std::string, double> truths(const Leg& leg) {
  return {{"drive.hip.friction", leg.dry[0]},
          {"drive.knee.friction", leg.dry[1]},
          {"drive.hip.viscous_friction", leg.viscous[0]},
          {"drive.knee.viscous_friction", leg.viscous[1]},
          {"robot.link.shank.mass", leg.mass[1]},
          {"robot.rail.viscous", leg.rail_viscous},
          {"robot.rail.friction", leg.rail_dry},
          {"robot.contact.toe.stiffness", leg.k},
          {"robot.contact.toe.damping_normal", leg.c},
          {"robot.contact.toe.friction", leg.mu},
          {"command.delay", leg.delay}};
}

}  // namespace

TEST_CASE("constants of a leg of three joints on a rail come back within their errors", "[driven]") {
  Random random(kSeed, 1000);
  double squares = 0;
  int n = 0, trusted = 0;
  const int draws = test::draws(1);
  for (int draw = 0; draw < draws; ++draw) {
    Leg leg;
    for (double* x : {&leg.dry[0], &leg.dry[1], &leg.viscous[0], &leg.viscous[1], &leg.mass[1], &leg.rail_viscous,
                      &leg.rail_dry, &leg.k, &leg.c, &leg.mu})
      *x *= random.uniform(0.8, 1.25);
    leg.delay = random.uniform(0.2e-3, 1.2e-3);
    const test::Folder folder;
    const DrivenRobot robot = read_driven_robot(folder.write("robot.toml", robot_of(leg, 1.1)));
    std::vector<RobotTrial> trials;
    for (int m = 0; m < 2; ++m)
      for (RobotTrial& t :
           read_robot_trials(folder.write(fmt::format("log_{}.csv", m),
                                          log_of(leg, 400, random.uniform(0, 6), std::uint64_t(10 * draw + m))),
                             robot.scene.robot, {.columns = ""}))
        trials.push_back(std::move(t));
    RobotFitOptions options;
    options.terms = robot_terms(robot, trials), options.threads = 2;
    const auto truth = truths(leg);
    for (const auto& [name, value] : truth) options.terms.free.push_back(name);
    const RobotFit fit = fit_robot(robot, trials, options);
    INFO("draw " << draw << ": " << fit.message << ", hip " << fit.rms[kAngle] << " rad of " << fit.noise[kAngle]);
    CHECK(fit.converged);
    for (const identify::Estimate& e : fit.parameters) {
      if (!e.free) continue;
      const double off = e.value - truth.at(e.name), z = e.std ? off / *e.std : 0;
      UNSCOPED_INFO(e.name << " " << e.value << ", true " << truth.at(e.name) << ", z " << z << " "
                           << identify::name(e.verdict));
      if (e.verdict != identify::Identifiability::kTrusted) continue;
      CHECK(std::abs(z) < 4);
      squares += z * z, ++n, ++trusted;
    }
  }
  CHECK(trusted > 0);
  const double rms = std::sqrt(squares / std::max(1, n)), spread = draws >= 30 ? 1.2 : 2;
  INFO("rms z " << rms << " of " << n << " trusted constants in " << draws << " draws");
  CHECK(rms < spread);
  if (draws >= 30) WARN("rms z " << rms << " of " << n << " trusted constants in " << draws << " draws");
}

TEST_CASE("an accelerometer and a force plate tell what angles leave open", "[driven]") {
  Leg leg;
  leg.slider = 1.05, leg.mu = 0.6;
  const test::Folder folder;
  std::string file = robot_of(leg, 1.1);
  const std::string mass = "mass = 1.05";
  file.replace(file.find(mass), mass.size(), "mass = 1.15");
  const DrivenRobot robot = read_driven_robot(folder.write("robot.toml", file));
  auto truth = truths(leg);
  truth["robot.link.slider.mass"] = leg.slider, truth["command.hip.torque_gain"] = 1;
  const auto fitted = [&](bool loads) {
    const auto trials = read_robot_trials(folder.write("log.csv", log_of(leg, 400, 1.3, 1, loads, "unread")),
                                          robot.scene.robot, {.columns = ""});
    RobotFitOptions options;
    options.terms = robot_terms(robot, trials), options.threads = 2;
    for (const auto& [name, value] : truth) options.terms.free.push_back(name);
    return fit_robot(robot, trials, options);
  };
  const RobotFit without = fitted(false), with = fitted(true);
  REQUIRE(with.converged);
  for (const identify::Estimate& e : with.parameters) {
    if (!e.free) continue;
    INFO(e.name << " " << e.value << ", true " << truth.at(e.name));
    REQUIRE(e.std);
    CHECK(std::abs(e.value - truth.at(e.name)) < 4 * *e.std);
  }
  const auto error = [](const RobotFit& fit, const std::string& name) {
    for (const identify::Estimate& e : fit.parameters)
      if (e.name == name) return e.std.value_or(std::numeric_limits<double>::infinity());
    return 0.0;
  };
  for (const char* name : {"robot.link.slider.mass", "command.hip.torque_gain", "robot.contact.toe.friction"}) {
    INFO(name << ": " << error(without, name) << " without, " << error(with, name) << " with");
    CHECK(error(with, name) < 0.5 * error(without, name));
  }
  for (std::size_t o = 0; o < with.channels.size(); ++o) {
    const double noise = with.channels[o].name == "ay" ? 0.05 : with.channels[o].unit == "N" ? 0.1 : 0;
    if (noise == 0 || with.channels[o].name == "ax" || with.channels[o].name == "acc") continue;
    INFO(with.channels[o].name);
    CHECK(with.rms[o] == Approx(noise).epsilon(0.15));
  }
}

TEST_CASE("a band of a touchdown is how it moves with the constants' errors", "[driven]") {
  const Leg leg;
  const test::Folder folder;
  DrivenRobot robot = read_driven_robot(folder.write("robot.toml", robot_of(leg, 1)));
  const auto trials =
      read_robot_trials(folder.write("log.csv", log_of(leg, 400, 1.3, 1)), robot.scene.robot, {.columns = ""});
  const double error = 0.01 * leg.mass[1];
  robot.known = {{{"robot.link.shank.mass"}, Eigen::Matrix<double, 1, 1>(error * error)}, {}};
  RobotFitOptions options;
  options.terms = robot_terms(robot, trials);
  const RobotFit here = predict_robot(robot, trials, options);
  robot.scene.robot.links[2].mass += error;
  const RobotFit moved = predict_robot(robot, trials, options);
  const auto &before = here.drops[0].changes, &after = moved.drops[0].changes;
  REQUIRE(here.bands.at(0).known());
  REQUIRE(before.size() == after.size());
  REQUIRE(before.size() > 1);
  for (std::size_t i = 0; i < before.size(); ++i) {
    INFO("change " << i << " at " << before[i].t << " moves by " << after[i].t - before[i].t);
    const double promised = here.bands[0].half_band(i) / kNormal975;
    CHECK(promised == Approx(std::abs(after[i].t - before[i].t)).epsilon(0.1).margin(5e-6));
    if (i > 0)
      CHECK(here.bands[0].half_band(i - 1, i) / kNormal975 ==
            Approx(std::abs(after[i].t - before[i].t - after[i - 1].t + before[i - 1].t)).epsilon(0.1).margin(5e-6));
  }
}

TEST_CASE("measured landings stand beside those of the rollout, with bands, and beside the mean of the others",
          "[driven]") {
  const Leg leg;
  const test::Folder folder;
  std::string heel = robot_of(leg, 1);
  const std::string drives = "[drive.hip]";
  heel.insert(heel.find(drives),
              "[[robot.contact]]\nname = \"hip\"\nlink = \"slider\"\nat = [0, 0]\nstiffness = 9000\n"
              "damping_normal = 60\ndamping_tangential = 0\n");
  DrivenRobot robot = read_driven_robot(folder.write("robot.toml", heel));
  std::string log = log_of(leg, 400, 1.3, 1, true), with;
  Random random(kSeed, 77);
  for (std::size_t from = 0, end; from < log.size(); from = end + 1) {  // the hip's own, which never touches
    end = log.find('\n', from);
    with +=
        log.substr(from, end - from) + (from == 0 ? ",f_hip_y" : fmt::format(",{:.6g}", 0.1 * random.normal())) + "\n";
  }
  const auto trials = read_robot_trials(folder.write("log.csv", with), robot.scene.robot, {.columns = ""});
  RobotFitOptions options;
  options.terms = robot_terms(robot, trials);
  const double error = 0.01 * leg.mass[1];
  robot.path.delay = leg.delay;
  robot.known = {{{"robot.link.shank.mass"}, Eigen::Matrix<double, 1, 1>(error * error)}, {}};
  const auto errors_of = [&] {
    const RobotFit followed = predict_robot(robot, trials, options);
    return stance_errors(robot, trials, compared_stances(robot, trials, followed));
  };
  const std::vector<StanceErrors> right = errors_of();
  REQUIRE(right.size() == 2);
  const auto of = [](const std::vector<StanceErrors>& all, bool toe) {
    return *std::find_if(all.begin(), all.end(), [&](auto& e) { return (e.contact == 0) == toe; });
  };
  const StanceErrors hip = of(right, false), toe = of(right, true);
  CHECK((hip.measured == 0 && hip.missed == 0 && hip.added == 0));
  CHECK(std::isnan(hip.touchdown.absolute));
  INFO(toe.measured << " landings, touchdown off " << toe.touchdown.absolute << " s, stance " << toe.duration.relative
                    << ", flight " << toe.flight.relative << ", by the others " << toe.duration.others << ", "
                    << toe.flight.others);
  CHECK(toe.measured >= 4);
  CHECK((toe.missed == 0 && toe.added == 0));
  CHECK(toe.flight.count == toe.measured - 1);  // none before the first
  CHECK(toe.touchdown.absolute < 2e-4);
  CHECK(toe.duration.relative < 0.003);
  CHECK(toe.flight.relative < 0.005);
  CHECK(toe.duration.others > 10 * toe.duration.relative);
  CHECK(toe.flight.others > 10 * toe.flight.relative);
  CHECK(toe.touchdown.within >= 0.5);
  // A robot that is another is told by its landings; its sensor's zero is not.
  robot.sensors.column["f_toe_y"] = {1, -20};
  auto shifted = trials;
  const std::vector<DropChannel> channels = sensed_channels(robot.scene.robot);
  for (std::size_t o = 0; o < channels.size(); ++o)
    if (channels[o].name == "f_toe_y")
      for (double& f : shifted[0].log.output[o]) f -= 20;
  const StanceErrors again =
      of(stance_errors(robot, shifted, compared_stances(robot, shifted, predict_robot(robot, shifted, options))), true);
  CHECK(again.duration.absolute == Approx(toe.duration.absolute).epsilon(0.01));
  robot.sensors.column.clear(), robot.scene.robot.links[2].mass *= 1.3;
  CHECK(of(errors_of(), true).flight.absolute > 5 * toe.flight.absolute);
}

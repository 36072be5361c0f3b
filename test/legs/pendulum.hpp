// A pendulum of two driven links by its textbook equations, with an integrator of its own: its logs with noise, and
// the robot that they are of.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "common/random.hpp"
#include "test/folder.hpp"
#include "tools/study/robot_trials.hpp"

namespace legs {

using namespace ukemi;
using namespace ukemi::landing;
using namespace ukemi::tools;

inline constexpr std::uint64_t kSeed = 20261126;

/// Two links that hang from a pin, each driven at its joint: Spong, Hutchinson, Vidyasagar, Robot Modeling and Control,
/// Eq. 7.87 f., with the relative angles q1 and q2, both 0 hanging; armatures, friction and a drive put to it.
struct Pendulum {
  double m1 = 0.8, m2 = 0.5, l1 = 0.3, r1 = 0.17, r2 = 0.12, i1 = 0.011, i2 = 0.006, g = 9.81;  // i about the masses
  double armature[2] = {0.004, 0.002}, dry[2] = {0.09, 0.05}, viscous[2] = {0.02, 0.015};
  double gain[2] = {1, 1}, k_p = 6, k_d = 0.2, limit[2] = {1e9, 1e9}, delay = 0;

  using State = std::array<double, 4>;

  State rate(const State& y, const double* asked) const {
    const double c2 = std::cos(y[1]), s2 = std::sin(y[1]), h = m2 * l1 * r2 * s2;
    const double d22 = m2 * r2 * r2 + i2, d12 = d22 + m2 * l1 * r2 * c2,
                 d11 = m1 * r1 * r1 + i1 + m2 * (l1 * l1 + r2 * r2 + 2 * l1 * r2 * c2) + i2;
    const double gravity2 = m2 * g * r2 * std::sin(y[0] + y[1]), gravity1 = (m1 * r1 + m2 * l1) * g * std::sin(y[0]);
    double tau[2];
    for (int j = 0; j < 2; ++j) {
      const double v = y[std::size_t(2 + j)], smooth = std::hypot(v, 2e-5);
      tau[j] = gain[j] * asked[j] - dry[j] * v / smooth - viscous[j] * v;
    }
    const double a = tau[0] + h * (2 * y[2] * y[3] + y[3] * y[3]) - gravity1 - gravity2,
                 b = tau[1] - h * y[2] * y[2] - gravity2;
    const double e11 = d11 + armature[0], e22 = d22 + armature[1], det = e11 * e22 - d12 * d12;
    return {y[2], y[3], (e22 * a - d12 * b) / det, (e11 * b - d12 * a) / det};
  }
  double asked(int j, const State& y, const double* ref, const double* ff) const {
    const double u = k_p * (ref[j] - y[std::size_t(j)]) - k_d * y[std::size_t(2 + j)] + ff[j];
    return std::clamp(u, -limit[j], limit[j]);
  }
  /// By Heun's method in steps of 2 us, in which dry friction that is smooth below 2e-5 rad/s is stable.
  void advance(State& y, const double* ref, const double* ff, double seconds) const {
    const int n = std::max(1, int(std::lround(seconds / 2e-6)));
    const double step = seconds / n;
    for (int k = 0; k < n; ++k) {
      double u[2] = {asked(0, y, ref, ff), asked(1, y, ref, ff)};
      const State f = rate(y, u);
      State z = y;
      for (std::size_t i = 0; i < 4; ++i) z[i] += step * f[i];
      u[0] = asked(0, z, ref, ff), u[1] = asked(1, z, ref, ff);
      const State e = rate(z, u);
      for (std::size_t i = 0; i < 4; ++i) y[i] += step / 2 * (f[i] + e[i]);
    }
  }
};

/// Commands of row k: references that swing with several frequencies, and torques.
inline void command(int k, std::uint64_t draw, double* ref, double* ff) {
  const double t = 0.004 * k, p = double(draw % 17);
  ref[0] = 0.6 * std::sin(3.1 * t + p) + 0.3 * std::sin(7.7 * t), ref[1] = 0.9 * std::sin(4.3 * t + 2 * p);
  ff[0] = 0.8 * std::sin(11 * t), ff[1] = 0.5 * std::sin(13 * t + p);
}

/// A log of the pendulum with noise, as a file.
inline std::string log_of(const Pendulum& p, int rows, std::uint64_t draw, double noise) {
  Random random(kSeed, draw);
  std::string out = "t,phi_hip,phi_knee,torque_hip,torque_knee,phi_ref_hip,phi_ref_knee,torque_ff_hip,torque_ff_knee\n";
  Pendulum::State y{0.1, -0.2, 0, 0};
  double ref[2], ff[2], before_ref[2], before_ff[2];
  command(0, draw, before_ref, before_ff);
  for (int k = 0; k < rows; ++k) {
    command(k, draw, ref, ff);
    out += fmt::format("{},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}\n", 0.004 * k,
                       y[0] + noise * random.normal(), y[1] + noise * random.normal(),
                       p.asked(0, y, before_ref, before_ff) + 0.01 * random.normal(),
                       p.asked(1, y, before_ref, before_ff) + 0.01 * random.normal(), ref[0], ref[1], ff[0], ff[1]);
    p.advance(y, before_ref, before_ff, p.delay);
    p.advance(y, ref, ff, 0.004 - p.delay);
    for (int j = 0; j < 2; ++j) before_ref[j] = ref[j], before_ff[j] = ff[j];
  }
  return out;
}

/// The pendulum's robot, each fitted number `off` times what it is.
inline std::string robot_of(const Pendulum& p, double off) {
  std::string out = fmt::format(R"([robot]
gravity = 9.81
base = "pinned"
peak = {{ link = "shank", at = [0.25, 0] }}
[[robot.link]]
name = "thigh"
joint = "hip"
mass = {}
inertia_com = {}
com = [{}, 0]
[[robot.link]]
name = "shank"
parent = "thigh"
at = [{}, 0]
joint = "knee"
mass = {}
inertia_com = {}
com = [{}, 0]
)",
                                p.m1, p.i1 * off, p.r1, p.l1, p.m2 * off, p.i2 * off, p.r2 / off);
  for (int j = 0; j < 2; ++j) {
    out += fmt::format("[drive.{}]\nkind = \"geared\"\nk_p = {}\nk_d = {}\ni_motor = {}\nfriction = {}\n",
                       j == 0 ? "hip" : "knee", p.k_p, p.k_d, p.armature[j], p.dry[j] / off);
    out += fmt::format("viscous_friction = {}\n", p.viscous[j] * off);
    if (p.limit[j] < 1e9) out += fmt::format("tau_max = {}\n", p.limit[j]);
  }
  return out;
}

struct Case {
  test::Folder folder;
  DrivenRobot robot;
  std::vector<RobotTrial> trials;
  RobotFitOptions options;

  Case(const Pendulum& p, double off, int logs, double pieces, const std::vector<std::string>& free,
       double noise = 2e-4) {
    robot = read_driven_robot(folder.write("robot.toml", robot_of(p, off)));
    for (int m = 0; m < logs; ++m)
      for (auto& t :
           read_robot_trials(folder.write(fmt::format("log_{}.csv", m), log_of(p, 750, std::uint64_t(m), noise)),
                             robot.scene.robot, {.columns = "", .pieces = pieces}))
        trials.push_back(t);
    options.terms = robot_terms(robot, trials);
    options.terms.free = free, options.threads = 2;
  }
};

inline const std::vector<std::string> kFree = {"robot.link.thigh.inertia_com", "robot.link.shank.mass",
                                               "robot.link.shank.inertia_com", "robot.link.shank.com.along",
                                               "drive.hip.friction",           "drive.knee.friction",
                                               "drive.hip.viscous_friction",   "drive.knee.viscous_friction"};

}  // namespace legs

#include "tools/bench/stability.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "common/degrees.hpp"
#include "common/random.hpp"
#include "landing/judge/sensitivity.hpp"

namespace ukemi::landing {

const char* name(Verdict verdict) {
  constexpr const char* kNames[] = {"pass", "sensitive", "coarse", "refused", "wrong"};
  return kNames[int(verdict)];
}

namespace {

/// A constant and the values that it is set to.
struct Factor {
  const char* name;
  std::vector<double> values;
  std::function<void(StabilityCase&, double)> set;
};

/// Powers of ten from 10^a to 10^b, with `first` in front.
std::vector<double> decades(int a, int b, std::vector<double> first = {}) {
  for (int i = a; i <= b; ++i) first.push_back(std::pow(10.0, i));
  return first;
}

std::vector<Factor> factors() {
  using C = StabilityCase;
  std::vector<double> pitches;
  for (int i = -165; i <= 180; i += 15) pitches.push_back(i);
  return {
      {"K_f", decades(2, 9), [](C& c, double v) { c.scene.floor->stiffness = v; }},
      {"C_fy", decades(-1, 6, {0}), [](C& c, double v) { c.scene.floor->damping_normal = v; }},
      {"C_fx", decades(-2, 6, {0}), [](C& c, double v) { c.scene.floor->damping_tangential = v; }},
      {"K_SEA", decades(-1, 8, {0}), [](C& c, double v) { c.sea.k_sea = v; }},
      {"C_SEA", decades(-2, 5, {0}), [](C& c, double v) { c.sea.c_sea = v; }},
      {"I_motor", decades(-8, 2), [](C& c, double v) { c.sea.i_motor = v; }},
      {"m_1/m_0", decades(-4, 4), [](C& c, double v) { c.scene.robot.mass[1] = v * c.scene.robot.mass[0]; }},
      {"I_0 = I_1", decades(-9, 1),
       [](C& c, double v) {
         c.scene.robot.inertia_com = {v, v};
       }},
      {"l", {0.01, 0.03, 0.1, 1, 3, 10}, [](C& c, double v) { c.scene.robot.link_length = v; }},
      {"h", decades(-6, 3, {0}), [](C& c, double v) { c.scene.drop.height = v; }},
      {"V_H", {-100, -10, -1, 0, 1, 10, 100}, [](C& c, double v) { c.scene.drop.forward_speed = v; }},
      {"phi_0", pitches, [](C& c, double v) { c.scene.drop.pitch = v * kDegree; }},
      {"dphi_0", {-100, -10, -1, 1, 10, 100}, [](C& c, double v) { c.scene.drop.pitch_rate = v; }},
      {"tau_max", decades(-3, 4, {0, 5, std::numeric_limits<double>::infinity()}),
       [](C& c, double v) { c.sea.tau_max = v; }},
      {"K_p", decades(-1, 6, {0}), [](C& c, double v) { c.sea.k_p = v; }},
      {"K_d", decades(-2, 6, {0}), [](C& c, double v) { c.sea.k_d = v; }},
      {"duration", decades(-4, 3), [](C& c, double v) { c.motion.duration = v; }},
  };
}

/// Situations that cannot be reached by varying a single constant.
std::vector<StabilityCase> special_cases(const StabilityCase& base) {
  std::vector<StabilityCase> out;
  const auto add = [&](const char* what, auto&& change) {
    StabilityCase c = base;
    c.factor = "special", c.setting = what;
    change(c);
    out.push_back(c);
  };
  using C = StabilityCase;
  const auto hold = [](double phi) { return Motion{phi, phi, 1}; };
  add("hip and knee touch at once", [&](C& c) { c.scene.drop.pitch = 90 * kDegree, c.motion = hold(-60 * kDegree); });
  add("knee and foot touch at once", [&](C& c) { c.scene.drop.pitch = 30 * kDegree, c.motion = hold(-120 * kDegree); });
  add("all three points touch at once", [&](C& c) { c.scene.drop.pitch = 90 * kDegree, c.motion = hold(0); });
  add("the foot grazes the floor: it turns past it at its lowest", [&](C& c) {
    c.scene.robot.gravity = 1e-3, c.scene.drop.height = 0.15 - 1e-9, c.scene.drop.pitch = 90 * kDegree;
    c.scene.drop.pitch_rate = 3, c.motion = hold(0), c.scene.t_end = 2;
  });
  add("chattering contact: case c019 of the reference set", [](C& c) {
    c.scene.robot = {{0.2345, 1.894}, {0.00197, 0.0359}, 0.45, 9.81};
    c.scene.floor = Floor<double>{3.5e3, 5, 80};
    c.motion = {-10 * kDegree, -70 * kDegree, 0.3};
  });
  for (const double tilt : {0.0, 1e-9, 1e-6, 1e-3})
    add("released upright on its foot, straight: it topples late", [&](C& c) {
      c.scene.drop = {0, 0, tilt, 0}, c.motion = hold(0);
    });
  add("balanced at the end, 3.5 mm inside its support", [](C& c) {
    c.motion = {-32.50056 * kDegree, -19.30209 * kDegree, 0.388696};
  });
  add("slides for seconds", [](C& c) { c.scene.drop.forward_speed = 5, c.scene.floor->damping_tangential = 0.1; });
  add("slides without friction", [](C& c) { c.scene.floor->damping_tangential = 0; });
  for (const double phi : {0.0, -45.0, -90.0})
    add("released on the floor", [&](C& c) { c.scene.drop.height = 0, c.motion = hold(phi * kDegree); });
  add("released lying on the floor", [&](C& c) { c.scene.drop = {0, 0, 90 * kDegree, 0}, c.motion = hold(0); });
  add("unstable gains", [](C& c) { c.sea.k_p = 500, c.sea.k_d = 0; });
  add("unstable gains, no torque limit",
      [](C& c) { c.sea.k_p = 500, c.sea.k_d = 0, c.sea.tau_max = std::numeric_limits<double>::infinity(); });
  add("one contact point", [](C& c) { c.scene.contacts = {false, false, true}; });
  add("dry friction and a stiffening spring", [](C& c) { c.sea.friction = 0.5, c.sea.k_sea_cubic = 1e4; });
  add("feedback of the motor's side", [](C& c) { c.sea.feedback = Feedback::kMotor; });
  return out;
}

}  // namespace

std::vector<StabilityCase> stability_grid(const Scene& base, const SeaParameters<double>& sea, int random,
                                          std::uint64_t seed, int stride) {
  const StabilityCase start{"", "", base, sea, {-40 * kDegree, -70 * kDegree, 0.25}};
  std::vector<StabilityCase> all;
  const std::vector<Factor> list = factors();
  for (const Factor& f : list)
    for (const double v : f.values) {
      StabilityCase c = start;
      f.set(c, v);
      c.factor = f.name, c.setting = fmt::format("{:g}", v);
      all.push_back(c);
    }
  for (const StabilityCase& c : special_cases(start)) all.push_back(c);
  for (int i = 0; i < random; ++i) {
    Random r(seed, std::uint64_t(i));
    StabilityCase c = start;
    c.factor = "random";
    for (int k = 0; k < 3; ++k) {
      const Factor& f = list[std::size_t(r.uniform(0, double(list.size())))];
      const double v = f.values[std::size_t(r.uniform(0, double(f.values.size())))];
      f.set(c, v);
      c.setting += fmt::format("{}{} = {:g}", k ? ", " : "", f.name, v);
    }
    all.push_back(c);
  }
  std::vector<StabilityCase> out;
  for (std::size_t i = 0; i < all.size(); i += std::size_t(stride)) out.push_back(all[i]);
  return out;
}

StabilityResult check_stability(const StabilityCase& c, const StabilityLimits& limits) {
  SimulateOptions options;
  options.max_steps = limits.max_steps;
  const Landing l = simulate(c.scene, c.sea, c.motion, options);
  StabilityResult out;
  out.peak = l.peak, out.energy_residual = l.energy_residual, out.work = l.work;
  if (l.end == End::kFailed) {
    out.failure = l.failure;
    const bool refused = l.failure == Failure::kIntegration || l.failure == Failure::kSteps;
    out.verdict = refused ? Verdict::kRefused : Verdict::kWrong;
    out.reason = reason(l);
    return out;
  }
  if (!std::isfinite(l.peak) || !std::isfinite(l.energy_residual)) {
    out.reason = "a number is not finite";
    return out;
  }
  options.accuracy /= 2;
  const LandingPeak half = peak_acceleration(c.scene, c.sea, c.motion, options);
  options.accuracy *= 2;
  out.halving = half.end == End::kFailed ? 1 : std::abs(half.peak / l.peak - 1);
  if (l.energy_residual > limits.energy) {
    out.reason = "the energy balance does not close";
    return out;
  }
  if (out.halving <= limits.halving) {
    out.verdict = Verdict::kPass;
    return out;
  }
  const Sensitivity s = sensitivity(c.scene, c.sea, c.motion, options, l.peak, 64);
  out.sensitivity = s.change;
  if (!s.checked) {
    out.verdict = Verdict::kRefused, out.failure = Failure::kSteps;
    out.reason = "it could not be checked: at a hundredth of the tolerance it cannot be followed";
    return out;
  }
  out.verdict = s.sensitive ? Verdict::kSensitive : Verdict::kWrong;
  if (!s.sensitive) out.reason = "the peak moves with the tolerance, not with the scene";
  return out;
}

}  // namespace ukemi::landing

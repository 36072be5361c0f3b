// A rig and its logs, simulated apart from the library: the classical Runge-Kutta method at 2e-5 s, the clamp of Eq. 2
// and dry friction that sticks as they are, and a delay by the history of what the drive asked for. For effects that a
// fit's model lacks.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "test/impact.hpp"

namespace test {

/// What the truth and the log have beyond Table 2 and 1 mrad of angle noise.
struct Effects {
  double viscous = 0;      ///< friction of the motor [Nm/(rad/s)]
  double dry = 0;          ///< Coulomb friction of the motor, sticking [Nm]
  double breakaway = 0;    ///< of it, falling by exp(-speed / 0.05 rad/s)
  double loss = 0;         ///< of the spring's torque, beside `dry`, with |tau| rounded within 10 mNm
  double asymmetry = 0;    ///< of `dry`: half the difference of its levels over their mean
  double out_viscous = 0;  ///< the same three of the output
  double out_dry = 0;
  double out_asymmetry = 0;
  double cubic = 0;   ///< of the spring [Nm/rad^3]
  double delay = 0;   ///< from what the drive measures to its torque [s]; 0 or at least 2e-5
  double filter = 0;  ///< time constant of the low-pass of the rate that K_d sees [s]
  Feedback feedback = Feedback::kOutput;
  std::function<double(double)> reference = {};  ///< phi_ref at a time [rad]; empty: 0
  double force_gain = 1;                         ///< logged force over true force
  double load_cell = 0;                          ///< standard deviation of the logged force's noise [N]
  double angle_noise = 1e-3;
  double inertia = 1, encoder_gain = 1;  ///< truth over the rig's, logged angle over truth
  double ripple = 0;                     ///< amplitude of the encoder's error, 8 waves a turn, 0 at the start [rad]
  double quantum = 0;                    ///< of the encoder [rad]; 0: none
  double strength = 1;                   ///< of the hits
};

struct HitOf {
  double newton, seconds;
};
inline constexpr HitOf kEightHits[] = {{40, 0.040},  {-60, 0.030}, {90, 0.024},  {120, 0.020},
                                       {-70, 0.040}, {110, 0.028}, {150, 0.020}, {-180, 0.018}};

/// The angle at every sample where `force(t)` [N] pushes the link; constants in the order of kConstantNames.
inline std::vector<double> joint_angle(const std::vector<double>& t, const std::function<double(double)>& force,
                                       const Effects& effects,
                                       const std::array<double, kConstants>& constants = kTruth) {
  const auto [kP, kD, kSea, cSea, iMotor] = constants;
  constexpr double kLength = 0.3, kInertia = 0.024225, kTauMax = 20, kStep = 2e-5;
  struct State {
    double phi = 0, phi_m = 0, omega = 0, omega_m = 0, filtered = 0;
    State plus(double h, const State& d) const {
      return {phi + h * d.phi, phi_m + h * d.phi_m, omega + h * d.omega, omega_m + h * d.omega_m,
              filtered + h * d.filtered};
    }
  };
  const auto spring = [&](const State& y) {
    const double d = y.phi_m - y.phi;
    return std::clamp(kSea * d + effects.cubic * d * d * d + cSea * (y.omega_m - y.omega), -kTauMax, kTauMax);
  };
  const bool motor = effects.feedback == Feedback::kMotor;
  const auto asked = [&](double at, const State& y) {
    const double rate = effects.filter > 0 ? y.filtered : motor ? y.omega_m : y.omega;
    return kP * ((effects.reference ? effects.reference(at) : 0) - (motor ? y.phi_m : y.phi)) - kD * rate;
  };
  std::vector<std::pair<double, double>> history;  // of time and what was asked then, a step each
  const auto driving = [&](double at, const State& y) {
    if (effects.delay == 0) return asked(at, y);
    const double then = at - effects.delay;
    if (then <= history.front().first) return history.front().second;
    const auto b = std::lower_bound(history.begin(), history.end(), std::pair(then, -1e300)), a = b - 1;
    return a->second + (b->second - a->second) * (then - a->first) / (b->first - a->first);
  };
  const auto on_motor = [&](double at, const State& y) {
    return driving(at, y) - effects.viscous * y.omega_m - spring(y);
  };
  const auto on_output = [&](const State& y, double f) {
    return spring(y) + kLength * std::cos(y.phi) * f - effects.out_viscous * y.omega;
  };
  // Signs of the sides' motion; 0: it sticks, where there is friction.
  int slip = 0, out_slip = 0;
  const bool rubs = effects.dry > 0 || effects.loss > 0, out_rubs = effects.out_dry > 0;
  const auto rubbing = [&](const State& y, int way) {
    const double carried = std::hypot(spring(y), 0.01) - 0.01;
    return (effects.dry + effects.loss * carried) * (1 + way * effects.asymmetry) *
           (1 + effects.breakaway * std::exp(-std::abs(y.omega_m) / 0.05));
  };
  const auto out_rubbing = [&](int way) { return effects.out_dry * (1 + way * effects.out_asymmetry); };
  const auto field = [&](double at, const State& y, double f) {
    const bool stuck = rubs && slip == 0, out_stuck = out_rubs && out_slip == 0;
    return State{out_stuck ? 0 : y.omega, stuck ? 0 : y.omega_m,
                 out_stuck ? 0 : (on_output(y, f) - out_slip * out_rubbing(out_slip)) / (effects.inertia * kInertia),
                 stuck ? 0 : (on_motor(at, y) - slip * rubbing(y, slip)) / iMotor,
                 effects.filter > 0 ? ((motor ? y.omega_m : y.omega) - y.filtered) / effects.filter : 0};
  };
  State y;
  std::vector<double> out{0};
  for (std::size_t i = 0; i + 1 < t.size(); ++i) {
    const int steps = int(std::ceil((t[i + 1] - t[i]) / kStep - 1e-9));
    const double h = (t[i + 1] - t[i]) / steps;
    for (int k = 0; k < steps; ++k) {
      const double now = t[i] + k * h;
      const auto f = [&](double part) { return force(now + part * h); };
      if (effects.delay > 0) history.emplace_back(now, asked(now, y));
      const auto leaves = [](double torque, auto&& level) {
        return torque > level(1) ? 1 : -torque > level(-1) ? -1 : 0;
      };
      if (rubs && slip == 0) slip = leaves(on_motor(now, y), [&](int way) { return rubbing(y, way); });
      if (out_rubs && out_slip == 0) out_slip = leaves(on_output(y, f(0)), out_rubbing);
      const State a = field(now, y, f(0)), b = field(now + h / 2, y.plus(h / 2, a), f(0.5)),
                  c = field(now + h / 2, y.plus(h / 2, b), f(0.5)), d = field(now + h, y.plus(h, c), f(1));
      y = y.plus(h / 6, a).plus(h / 3, b).plus(h / 3, c).plus(h / 6, d);
      if (slip != 0 && y.omega_m * slip < 0) y.omega_m = 0, slip = 0;
      if (out_slip != 0 && y.omega * out_slip < 0) y.omega = 0, out_slip = 0;
    }
    out.push_back(y.phi);
  }
  return out;
}

/// The same where the force is linear between the samples of a log.
inline std::vector<double> joint_angle(const std::vector<double>& t, const std::vector<double>& force,
                                       const Effects& effects,
                                       const std::array<double, kConstants>& constants = kTruth) {
  std::size_t i = 0;
  return joint_angle(
      t,
      [&](double at) {
        while (i > 0 && t[i] > at) --i;
        while (i + 2 < t.size() && t[i + 1] <= at) ++i;
        return force[i] + (force[i + 1] - force[i]) * (at - t[i]) / (t[i + 1] - t[i]);
      },
      effects, constants);
}

/// Logs of eight hits at 500 Hz for 1 s, simulated.
inline std::vector<Trial> eight_hits(const Effects& effects, std::uint64_t seed,
                                     const std::array<double, kConstants>& constants = kTruth) {
  std::vector<Trial> out;
  for (const HitOf& hit : kEightHits) {
    Trial log;
    log.file = "hit_" + std::to_string(out.size() + 1);
    Random random(seed, out.size());
    for (int i = 0; i <= 500; ++i) {
      log.t.push_back(i / 500.0);
      const double s = (log.t.back() - 0.05) / hit.seconds;
      log.force.push_back(s > 0 && s < 1 ? effects.strength * hit.newton * std::sin(std::numbers::pi * s) : 0);
    }
    log.phi = joint_angle(log.t, log.force, effects, constants);
    for (double& x : log.phi) {
      x = effects.encoder_gain * x + effects.ripple * std::sin(8 * x) + effects.angle_noise * random.normal();
      if (effects.quantum > 0) x = effects.quantum * std::round(x / effects.quantum);
    }
    for (double& f : log.force) f = effects.force_gain * f + effects.load_cell * random.normal();
    out.push_back(log);
  }
  return out;
}

/// The log without `count` rows from `first` on.
inline void drop_rows(Trial& log, std::size_t first, std::size_t count) {
  for (std::vector<double>* column : {&log.t, &log.phi, &log.force})
    column->erase(column->begin() + long(first), column->begin() + long(first + count));
}

}  // namespace test

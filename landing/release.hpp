// How a landing begins: the state at release, and the flight that follows it in closed form.
#pragma once

#include <cmath>
#include <limits>

#include "landing/landing_system.hpp"

namespace ukemi::landing {

/// State at release, x_0 = 0, the lowest contact point at the drop's height.
template <class System>
typename System::State released(const System& system, const Scene& scene, const Motion& motion) {
  typename System::State y = System::State::Zero();
  y[kTheta0] = scene.drop.pitch, y[kTheta1] = scene.drop.pitch + motion.phi_i, y[kPhiM] = motion.phi_i;
  y[kVx] = scene.drop.forward_speed;
  y[kOmega0] = y[kOmega1] = scene.drop.pitch_rate;
  const Pose<double> p = system.pose(y);
  const double k = system.link.k1 * system.link.a;
  y[kX] = k * (p.s0 + p.s1);  // r_0 = (0, .)
  y[kVx] += k * (p.omega0 * p.c0 + p.omega1 * p.c1);
  y[kVy] = k * (p.omega0 * p.s0 + p.omega1 * p.s1);
  double lowest = std::numeric_limits<double>::infinity();
  for (int j = 0; j < kPoints; ++j)
    if (scene.contacts[j] || !scene.touches()) lowest = std::min(lowest, height(system.link, p, j));
  y[kY] = scene.drop.height - lowest;
  return y;
}

/// With no pitch rate nothing moves relative to anything else until the floor is reached: ballistic, in closed form.
inline bool is_ballistic(const Scene& scene) { return scene.drop.pitch_rate == 0; }
/// How long it then takes to the floor; infinite if it never comes [s].
inline double fall_time(const Scene& scene) {
  const double g = scene.robot.gravity;
  if (!scene.touches() || !(g > 0 || scene.drop.height == 0)) return std::numeric_limits<double>::infinity();
  return g > 0 ? std::sqrt(2 * scene.drop.height / g) : 0;
}
/// The state after `t` of ballistic flight from release; on the floor if t is `fall_time`.
template <class State>
void fly(const Scene& scene, double t, State& y) {
  const double g = scene.robot.gravity;
  y[kX] += y[kVx] * t, y[kVy] = -g * t;
  y[kY] -= t == fall_time(scene) ? scene.drop.height : 0.5 * g * t * t;
}

}  // namespace ukemi::landing

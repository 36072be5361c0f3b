// The start of a landing: the state at release, and the following flight in closed form.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "landing/model/landing_system.hpp"

namespace ukemi::landing {

/// State at release: x_0 = 0, the lowest contact point at the drop's height. Drop and motion have the system's scalar;
/// of the scene only the contacts are used.
template <class System, class T>
typename System::State released(const System& system, const Scene& scene, const DropOf<T>& drop,
                                const MotionOf<T>& motion) {
  typename System::State y;
  for (int i = 0; i < y.size(); ++i) y[i] = T(0);
  y[kTheta0] = drop.pitch, y[kTheta1] = drop.pitch + motion.release_phi(), y[kPhiM] = motion.release_phi();
  y[kVx] = drop.forward_speed;
  y[kOmega0] = y[kOmega1] = drop.pitch_rate;
  y[kOmega1] += motion.release_rate(), y[kOmegaM] = motion.release_rate();
  const Pose<T> p = system.pose(y);
  const T k(system.link.k1 * system.link.a);
  y[kX] = k * (p.s0 + p.s1);  // r_0 = (0, .)
  y[kVx] += k * (p.omega0 * p.c0 + p.omega1 * p.c1);
  y[kVy] = drop.vertical_speed + k * (p.omega0 * p.s0 + p.omega1 * p.s1);
  T lowest(std::numeric_limits<double>::infinity());
  for (int j = 0; j < kPoints; ++j)
    if (scene.contacts[j] || !scene.touches()) {
      const T h = height(system.link, p, j);
      lowest = select(h < lowest, h, lowest);
    }
  y[kY] = drop.height - lowest;
  system.steady(y);
  return y;
}

/// Whether the flight is ballistic, in closed form, until a touchdown or a move of the reference: no rates at release.
inline bool is_ballistic(const Drop& drop, double joint_rate) { return drop.pitch_rate == 0 && joint_rate == 0; }
/// Duration of a fall from height h [m] at g [m/s^2] with speed v upwards [m/s]; infinite if it never ends [s].
inline double fall_time(double g, double h, double v) {
  if (!(g > 0 || h == 0 || v < 0)) return std::numeric_limits<double>::infinity();
  if (!(g > 0)) return h == 0 ? 0 : h / -v;
  return v == 0 ? std::sqrt(2 * h / g) : (v + std::sqrt(v * v + 2 * g * h)) / g;
}
/// Duration of a ballistic fall to the floor; infinite if it is not reached [s].
inline double fall_time(const Scene& scene) {
  if (!scene.touches()) return std::numeric_limits<double>::infinity();
  return fall_time(scene.robot.gravity, scene.drop.height, scene.drop.vertical_speed);
}
/// Time limit before the first touchdown: t_end, else an upper bound of the flight plus Scene::kFollow [s].
inline double flight_limit(const Scene& scene, const Motion& motion) {
  if (scene.t_end) return *scene.t_end;
  const double g = scene.robot.gravity, joint_rate = motion.release_rate();
  if (!scene.touches() || !(g > 0)) return Scene::kFollow;
  if (is_ballistic(scene.drop, joint_rate) && !motion.reposition) return fall_time(scene) + Scene::kFollow;
  const double reach = 2 * scene.robot.link_length;  // upper bound of a point's distance from the centre of mass
  const double rise =
      reach * (std::abs(scene.drop.pitch_rate) + std::abs(joint_rate)) + std::max(0.0, scene.drop.vertical_speed);
  return (rise + std::sqrt(rise * rise + 2 * g * (scene.drop.height + 2 * reach))) / g + Scene::kFollow;
}
/// The state after `t` of ballistic flight from release; on the floor if t is `fall_time`. Derivatives are those at a
/// fixed t.
template <class System>
void fly(const System& system, const Scene& scene, double t, typename System::State& y) {
  using T = typename System::State::Scalar;
  const T g(system.link.gravity), v = y[kVy];
  T fallen = T(0.5) * g * T(t) * T(t) - v * T(t);
  if (t == fall_time(scene)) fallen += T(scene.drop.height - value_of(fallen));  // exactly on the floor
  y[kX] += y[kVx] * T(t), y[kVy] = v - g * T(t);
  y[kY] -= fallen;
}

}  // namespace ukemi::landing

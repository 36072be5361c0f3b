// The flight before a landing in closed form.
#pragma once

#include <cmath>
#include <limits>

#include "landing/model/scene.hpp"

namespace ukemi::landing {

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

}  // namespace ukemi::landing

// Deviations of a drive, a drop and a motion from what was planned.
#pragma once

#include <span>

#include "landing/model/motion_data.hpp"
#include "landing/model/scene.hpp"

namespace ukemi::landing {

/// The drive with each constant moved by `deviation`, in the order of actuator_constants(), clamped to its range.
SeaParameters<double> moved(SeaParameters<double> sea, std::span<const double> deviation);
/// Moves height, pitch and speeds. Returns whether the drop would begin below the floor; it is then moved onto it.
bool move_drop(Drop& drop, const Scatter& deviation);
/// The motion of a joint that is released at these offsets from the planned angle and rate [rad], [rad/s].
Motion released_beside(Motion motion, double phi, double rate);

}  // namespace ukemi::landing

// What keeps a rating in a scene.
#pragma once

#include <limits>

#include "landing/body/load.hpp"

namespace ukemi::landing {

/// The largest value of a load that keeps its rating; infinite for the torque of a geared motor that its limit,
/// tau_max, keeps within it: lanes, which place that limit's event less exactly, may read a little more.
inline double allowed(const Load& load, const Robot& robot) {
  if (load.kind == Load::Kind::kMotorTorque) {
    const Joint& j = robot.joints[std::size_t(load.index)];
    if (j.kind == DriveKind::kGeared && j.sea.tau_max <= load.rating) return std::numeric_limits<double>::infinity();
  }
  return allowed(load.rating);
}

}  // namespace ukemi::landing

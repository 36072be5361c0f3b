// Pose of a robot of links at rest, for checks before a drop.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "landing/body/equations.hpp"

namespace ukemi::landing {

/// The pose with the joints at phi, by index of Robot::joints [rad], the base's point in the origin. The joint of a
/// pinned base, unless it is driven, follows from the first link's pitch.
inline TreePose<double, kAny.bodies> rest_pose(const Robot& robot, const Body<double, kAny>& body, double pitch,
                                               const std::vector<double>& phi) {
  std::array<double, kAny.bodies> theta{};
  theta[0] = pitch;
  for (int i = 0; i < body.joints; ++i) {
    const TreeJoint& at = body.joint[std::size_t(i)];
    const auto joint = std::size_t(at.joint);
    if (at.parent < 0 && !robot.joints[joint].driven()) continue;
    theta[std::size_t(at.child)] = (at.parent < 0 ? 0 : theta[std::size_t(at.parent)]) + phi[joint] - at.offset;
  }
  TreePose<double, kAny.bodies> out{};
  for (std::size_t j = 0; j < theta.size(); ++j) out.sin[j] = std::sin(theta[j]), out.cos[j] = std::cos(theta[j]);
  return out;
}

}  // namespace ukemi::landing

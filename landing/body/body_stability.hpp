// Whether the drives of a robot in flight come to rest by themselves.
#pragma once

#include <optional>

#include "landing/body/body_scene.hpp"

namespace ukemi::landing {

/// Drives that are unstable in flight, see `growth`.
struct BodyInstability {
  double rate;   ///< growth rate of the unstable mode [1/s], > 0
  int joint;     ///< of Robot::joints, with the largest rate in that mode
  bool landing;  ///< at phi_F with the landing gains; else at phi_I
};
/// The faster one at the two ends of a motion, without gravity and torque limits; absent: stable.
[[nodiscard]] std::optional<BodyInstability> instability(const BodyScene& scene, const BodyMotion& motion);

}  // namespace ukemi::landing

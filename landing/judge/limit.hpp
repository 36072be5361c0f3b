// The physical limit of a drop: the smallest peak that any reference can reach.
#pragma once

#include "common/sea.hpp"
#include "landing/model/scene.hpp"

namespace ukemi::landing {

/// No torque acts yet at the first touchdown, so |ddr_0| right after it depends on the joint angle alone. Without a
/// move in the air no motion has a lower peak than the smallest of these; with one, a joint that still turns at
/// touchdown may be lower.
struct TouchdownLimit {
  double jump = 0;               ///< the smallest |ddr_0| right after the first touchdown [m/s^2]
  double jump_phi = 0;           ///< its joint angle [rad]
  double first_contact = 0;      ///< the smallest peak until kFirstContact after it, the joint held [m/s^2]
  double first_contact_phi = 0;  ///< its joint angle [rad]
  bool found = false;            ///< false: no posture touches the floor

  static constexpr double kFirstContact = 0.02;  ///< [s]
};

/// Over the postures of the scene's search range within the joint's stops, released as the drop says with the joint at
/// rest and the reference held; the scene's release and detection delay are ignored. By grids refined around the best
/// angle, to 0.01 deg. Tests: test/property/air.cpp.
[[nodiscard]] TouchdownLimit touchdown_limit(const Scene& scene, const SeaParameters<double>& sea, int threads = 0);

}  // namespace ukemi::landing

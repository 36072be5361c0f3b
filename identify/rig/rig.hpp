// The impact-test rig of Sec. 3 of [1]: one link on a fixed base, horizontal plane.
#pragma once

#include <optional>
#include <string>

#include "common/sea.hpp"

namespace ukemi::identify {

struct Rig {
  double length;                         ///< l, from the joint to where the force acts [m], > 0
  double inertia;                        ///< M, of the link about the joint [kg m^2], > 0
  std::optional<double> tau_max;         ///< torque limit of the spring [Nm]
  std::optional<double> gear_ratio;      ///< a log's phi_motor is divided by it
  std::optional<Feedback> feedback;      ///< what Eq. 3 feeds back
  std::optional<double> speed_max = {};  ///< rated motor speed at the output [rad/s], for the actuator file
};

/// Reads rig.toml: [rig] length and inertia_joint, or mass + inertia_com (then M = I + m (l/2)^2, Eq. 5). Throws
/// InputError.
Rig read_rig(const std::string& path);

}  // namespace ukemi::identify

// Exports an identified actuator as a simulator's model: MuJoCo's MJCF, or URDF with Gazebo's extensions.
#pragma once

#include <string>

#include "common/actuator.hpp"

namespace ukemi::tools {

/// The link that the actuator moves on its rig; no gravity.
struct RigLink {
  double length;   ///< from the joint to the tip [m], > 0
  double inertia;  ///< about the joint [kg m^2], > 0
};

/// A complete model of the rig; the elements between link and base can be copied into another robot's model. XML
/// comments give `comments`, where each constant went with its standard error, and what the format cannot hold.
///
/// MJCF: rotor and link are two joints on one axis; i_motor is the rotor's armature, K_SEA and C_SEA a fixed tendon of
/// length phi_m - phi_1. This is Eq. 2-4 of [1] without the limit of Eq. 2.
std::string mjcf(const Actuator& actuator, const RigLink& link, const std::string& joint, const std::string& comments);
/// URDF: rotor and spring are two joints in series; the spring's stiffness is an element of Gazebo's.
std::string urdf(const Actuator& actuator, const RigLink& link, const std::string& joint, const std::string& comments);

}  // namespace ukemi::tools

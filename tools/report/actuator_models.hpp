// An identified actuator as lines of a simulator's model: MuJoCo's MJCF, URDF with Gazebo's extensions.
#pragma once

#include <string>

#include "common/actuator.hpp"

namespace ukemi::tools {

/// The link that an actuator moves on its rig: no gravity, a force at the tip.
struct RigLink {
  double length;   ///< from the joint to the tip [m], > 0
  double inertia;  ///< about the joint [kg m^2], > 0
};

/// A whole model of the rig, of which the lines between the link and its base are for another robot. What each constant
/// became, its standard error and what the format cannot hold stand in comments; so do the lines of `comments`.
///
/// MJCF: rotor and link are two joints on one axis; i_motor is the rotor's armature, K_SEA and C_SEA a fixed tendon of
/// length phi_m - phi_1. This is Eq. 2-4 of [1] but for the limit of Eq. 2.
std::string mjcf(const Actuator& actuator, const RigLink& link, const std::string& joint, const std::string& comments);
/// URDF: rotor and spring are two joints in a row; the spring's stiffness is Gazebo's.
std::string urdf(const Actuator& actuator, const RigLink& link, const std::string& joint, const std::string& comments);

}  // namespace ukemi::tools

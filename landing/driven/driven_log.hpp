// What a robot's joints were told, row by row, and what was measured meanwhile.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "landing/body/robot.hpp"

namespace ukemi::landing {

/// What a drive may be told in a row; what is missing in a log is none of it, and of the gains those of the robot.
enum CommandColumn { kPhiRef, kDphiRef, kTorqueFf, kKp, kKd, kOn, kTold };
/// `on`: the share of the torque that acts, 0: the drive is switched off.
inline constexpr std::array<const char*, kTold> kToldNames = {"phi_ref", "dphi_ref", "torque_ff", "k_p", "k_d", "on"};

/// The commands of a log; each is held from its row to the next.
struct Commands {
  std::vector<double> t;  ///< of the rows [s], increasing
  /// Of Robot::joints, then by CommandColumn: one a row, or none at all.
  std::vector<std::array<std::vector<double>, kTold>> joint;
};

/// What is measured of a driven joint.
enum Sensed { kAngle, kRate, kTorque, kSensed };
inline constexpr std::array<const char*, kSensed> kSensedNames = {"phi", "dphi", "torque"};
inline constexpr std::array<const char*, kSensed> kSensedUnits = {"rad", "rad/s", "Nm"};

/// Angle and rate of a joint, and of the motor behind a spring.
struct JointStart {
  double phi = 0, dphi = 0, spring = 0;  ///< spring: phi_m - phi, the motor's rate is the joint's
};

/// Where a trial starts. A base on a rail stands so that the lowest contact is `height` over its surface [m] and
/// rises with `speed` [m/s].
struct DrivenStart {
  std::vector<JointStart> joint;  ///< of Robot::joints
  double height = 0, speed = 0;
};

/// How far a robot on a rail reaches below its base, along the rail, at each row of joint angles (of Robot::joints)
/// [m].
std::vector<double> extensions(const Robot& robot, const std::vector<std::vector<double>>& phi);

/// Throws InputError where the fit of trials has no law for a robot: a free base, a pinned first link without a joint.
void check_driven(const Robot& robot);

}  // namespace ukemi::landing

// What a robot's joints were told, row by row, and what was measured meanwhile.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "landing/body/sensors.hpp"

namespace ukemi::landing {

/// What a drive may be told in a row; what is missing in a log is none of it, and of the gains those of the robot.
enum CommandColumn { kPhiRef, kDphiRef, kTorqueFf, kKp, kKd, kOn, kTold };
/// `on`: the share of the torque that acts, 0: the drive is switched off.
inline constexpr std::array<const char*, kTold> kToldNames = {"phi_ref", "dphi_ref", "torque_ff", "k_p", "k_d", "on"};

/// A controller in the loop, by the state at a row: adds to `torque` what it asks of each driven joint [Nm]. All are of
/// Robot::joints; t of the log's clock [s], angles [rad], rates [rad/s]. Called from several threads at once.
using Controller =
    std::function<void(double t, std::span<const double> phi, std::span<const double> dphi, std::span<double> torque)>;

/// The commands of a log; each is held from its row to the next.
struct Commands {
  std::vector<double> t;  ///< of the rows [s], increasing
  Controller controller;  ///< its torque comes beside what the columns ask, through the same path; if set
  /// Of Robot::joints, then by CommandColumn: one a row, or none at all.
  std::vector<std::array<std::vector<double>, kTold>> joint;
  /// Of Robot::pushes: the force on the robot along and across the floor [N], a curve from row to row
  /// (Sensors::push_smooth); one a row, or none at all.
  std::vector<std::array<std::vector<double>, 2>> push;
};

/// Angle and rate of a joint, and of the motor behind a spring.
struct JointStart {
  double phi = 0, dphi = 0, spring = 0;  ///< spring: phi_m - phi, the motor's rate is the joint's
};

/// Where a trial starts. A base that is not pinned stands so that the lowest contact is `height` over its surface [m]
/// and rises with `speed` [m/s]; where `y` says how high the first link's origin is, and rises, both are added to that.
struct DrivenStart {
  std::vector<JointStart> joint;  ///< of Robot::joints
  double height = 0, speed = 0;
  double x = 0, forward_speed = 0;         ///< of a free base: its first link's origin [m], [m/s]
  double pitch = 0, pitch_rate = 0;        ///< and its absolute angle [rad], [rad/s]
  std::optional<std::array<double, 2>> y;  ///< [m], [m/s]
};

/// How far a robot on a rail reaches below its base, along the rail, at each row of joint angles (of Robot::joints)
/// [m].
std::vector<double> extensions(const Robot& robot, const std::vector<std::vector<double>>& phi);

/// Throws InputError where the fit of trials has no law for a robot: a pinned first link without a joint.
void check_driven(const Robot& robot);

}  // namespace ukemi::landing

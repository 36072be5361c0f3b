// Commands of a trial of a driven robot, row by row, and its start.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "landing/body/sensors.hpp"

namespace ukemi::landing {

/// Command columns of a drive; missing ones are 0, gains those of the robot, `on` 1.
enum CommandColumn { kPhiRef, kDphiRef, kTorqueFf, kKp, kKd, kOn, kCommandColumns };
/// `on`: factor of the torque; 0: the drive is switched off.
inline constexpr std::array<const char*, kCommandColumns> kCommandColumnNames = {"phi_ref", "dphi_ref", "torque_ff",
                                                                                 "k_p",     "k_d",      "on"};

/// A controller in the loop, called with the state at each row: adds its requested torques to `torque` [Nm]. Spans are
/// of Robot::joints; t by the log's clock [s], angles [rad], rates [rad/s]. Called from several threads at once.
using Controller =
    std::function<void(double t, std::span<const double> phi, std::span<const double> dphi, std::span<double> torque)>;

/// The commands of a log; each is held from its row to the next.
struct Commands {
  std::vector<double> t;  ///< of the rows [s], increasing
  Controller controller;  ///< if set, its torque is added to the columns' request
  /// Of Robot::joints, then by CommandColumn: one value per row, or none at all.
  std::vector<std::array<std::vector<double>, kCommandColumns>> joint;
  /// Of Robot::pushes: the force on the robot along and across the floor [N], a curve from row to row
  /// (Sensors::push_smooth); one value per row, or none at all.
  std::vector<std::array<std::vector<double>, 2>> push;
};

/// Angle and rate of a joint at the start, and deflection of its spring.
struct JointStart {
  double phi = 0, dphi = 0, spring = 0;  ///< spring: phi_m - phi; the motor has the joint's rate
};

/// Initial state of a trial. Unless pinned, the base is placed so that the lowest contact is `height` above its surface
/// [m] and rises with `speed` [m/s]; if `y` gives height and speed of the first link's origin, both are added to it.
struct DrivenStart {
  std::vector<JointStart> joint;  ///< of Robot::joints
  double height = 0, speed = 0;
  double x = 0, forward_speed = 0;         ///< of a free base: first link's origin [m], [m/s]
  double pitch = 0, pitch_rate = 0;        ///< and its absolute angle [rad], [rad/s]
  std::optional<std::array<double, 2>> y;  ///< [m], [m/s]
};

/// Reach of a robot's contacts below its base, along the rail, for each row of joint angles phi[joint][row] [m].
std::vector<double> extensions(const Robot& robot, const std::vector<std::vector<double>>& phi);

/// Throws InputError for a robot that trials do not support: a pinned first link without a joint.
void check_driven(const Robot& robot);

}  // namespace ukemi::landing

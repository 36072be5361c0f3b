// The path of a logged command to a joint's motor. For the logged torque see sensors.hpp. Ours.
//
//     phi_read  = phi + offset
//     requested = clamp(K_p (phi_ref - phi_read) + K_d (dphi_ref - dphi) + torque_ff, low, high)
//     motor     = torque_gain requested
//
// The command of row k acts from `delay` after the time of row k + rows until the next command does.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "common/toml.hpp"
#include "landing/body/robot.hpp"

namespace ukemi::landing {

/// Largest delay of a command [s].
inline constexpr double kMaxCommandDelay = 0.1;
inline constexpr int kMaxCommandRows = 100;

/// "command.hip.torque_gain".
inline std::string gain_name(const Joint& joint) { return "command." + joint.name + ".torque_gain"; }

struct CommandPath {
  struct Joint {
    double torque_gain = 1;                                        ///< > 0
    double torque_low = -std::numeric_limits<double>::infinity();  ///< limits of `requested` [Nm], < 0
    double torque_high = std::numeric_limits<double>::infinity();  ///< > 0
    double offset = 0;  ///< zero error of the encoder: its reading minus the joint's angle [rad]
  };
  double delay = 0;           ///< [s], from 0 to kMaxCommandDelay
  int rows = 0;               ///< delay in rows, from 0 to kMaxCommandRows
  std::vector<Joint> joints;  ///< of Robot::joints; unused where not driven
};

/// A number of a path by its name, "delay" or "JOINT.KEY"; null if there is none.
double* command_number(CommandPath& path, const Robot& robot, const std::string& name);
/// Reads [command] delay, rows and [command.JOINT] KEY of a robot's file. Omitted numbers have no effect; the torque
/// limits of a geared drive default to -+ tau_max.
CommandPath read_command_path(TomlFile& file, const Robot& robot);

/// Applies the path to a robot's geared drives, as landings need it: gains and torque limit times torque_gain, the
/// limit being the smaller of |low| and high. Delays and offsets are not applied.
void apply(const CommandPath& path, Robot& robot);

}  // namespace ukemi::landing

// What a logged command passes through on its way to a joint's motor. What is logged of the torque: sensors.hpp. Ours.
//
//     phi_read = phi + offset
//     asked    = clamp(K_p (phi_ref - phi_read) + K_d (dphi_ref - dphi) + torque_ff, low, high)
//     motor    = torque_gain asked
//
// A row's command acts `delay` after the time of the row that is `rows` behind it, until the next one does.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "common/toml.hpp"
#include "landing/body/robot.hpp"

namespace ukemi::landing {

/// Largest delay of a command [s].
inline constexpr double kMostCommandDelay = 0.1;
inline constexpr int kMostCommandRows = 100;

/// "command.hip.torque_gain".
inline std::string gain_name(const Joint& joint) { return "command." + joint.name + ".torque_gain"; }

struct CommandPath {
  struct Joint {
    double torque_gain = 1;                                        ///< > 0
    double torque_low = -std::numeric_limits<double>::infinity();  ///< levels of `asked` [Nm], < 0
    double torque_high = std::numeric_limits<double>::infinity();  ///< > 0
    double offset = 0;  ///< what the encoder reads beyond the joint's angle, its zero's error [rad]
  };
  double delay = 0;           ///< [s], from 0 to kMostCommandDelay
  int rows = 0;               ///< a row acts so many rows late, from 0 to kMostCommandRows
  std::vector<Joint> joints;  ///< of Robot::joints; of those that are not driven without meaning
};

/// A number of a path by its name, "delay" or "JOINT.KEY"; null: there is none.
double* command_number(CommandPath& path, const Robot& robot, const std::string& name);
/// [command] delay, rows and [command.JOINT] KEY of a robot's file. What is omitted changes nothing; of the levels it
/// is -+ tau_max of the joint's drive.
CommandPath read_command_path(TomlFile& file, const Robot& robot);

/// The drives as a landing has them, behind the same path: of a geared motor gains and limit are torque_gain times as
/// large, the limit that of the level that is nearer to zero. Delays and offsets are left out: angles are the joint's.
void apply(const CommandPath& path, Robot& robot);

}  // namespace ukemi::landing

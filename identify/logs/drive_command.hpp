// What a drive told the motor, where that is known before the rig's motion is: from a trial's columns.
#pragma once

#include <vector>

#include "identify/logs/trial.hpp"

namespace ukemi::identify {

/// At each sample, held to the next [V, A or Nm]: the logged command, or gain (phi_ref - phi) of a controller that is
/// fed the logged angle (Drive::Angle::kLogged); within the drive's limit, and from the first sample on within its
/// rate. The logged command as it is where another drive turns the motor. Throws InputError where a column is missing.
std::vector<double> drive_command(const Trial& trial, const Drive& drive);

}  // namespace ukemi::identify

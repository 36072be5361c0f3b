// A drive's command, from a trial's columns, where it is known before the rollout.
#pragma once

#include <vector>

#include "identify/logs/trial.hpp"

namespace ukemi::identify {

/// At each sample, held to the next [V, A or Nm]: the logged command, or gain (phi_ref - phi) of a controller that is
/// fed the logged angle (Drive::Angle::kLogged); limited to the drive's range and, from the first sample on, to its
/// rate. Of other drives the logged command, unchanged. Throws InputError where a column is missing.
std::vector<double> drive_command(const Trial& trial, const Drive& drive);

}  // namespace ukemi::identify

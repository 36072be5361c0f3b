// Preparation of trials, as in the verbs.
#pragma once

#include <optional>
#include <vector>

#include "identify/logs/trial.hpp"

namespace ukemi::python {

/// Trials with zero force between hits and the command of the rig's drive. force_noise [N], >= 0.
std::vector<identify::Trial> prepared(std::vector<identify::Trial> trials, const identify::Rig& rig,
                                      std::optional<double> force_noise);

}  // namespace ukemi::python

// Trials as the verbs take them.
#pragma once

#include <optional>
#include <vector>

#include "identify/logs/trial.hpp"

namespace ukemi::python {

/// The force at rest between hits, the command as the rig's drive gives it. force_noise [N], >= 0.
std::vector<identify::Trial> prepared(std::vector<identify::Trial> trials, const identify::Rig& rig,
                                      std::optional<double> force_noise);

}  // namespace ukemi::python

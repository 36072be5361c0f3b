// The rows of a landing as files.
#pragma once

#include <string>
#include <vector>

#include "landing/judge/checked.hpp"
#include "tools/program/output.hpp"

namespace ukemi::tools {

/// trajectory.csv.
std::string trajectory_csv(const std::vector<landing::Sample>& trajectory, const Run& run);
/// The same for PlotJuggler, which takes no `#` lines and one row a time: names with units and '/', without blanks; the
/// second row of an event comes the smallest step of a number later.
std::string plotjuggler_csv(const std::vector<landing::Sample>& trajectory);

}  // namespace ukemi::tools

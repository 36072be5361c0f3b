// A robot of links and its logs, as verbs read them; both become inputs of the run.
#pragma once

#include <string>
#include <vector>

#include "tools/study/robot_trials.hpp"
#include "tools/verbs/runs.hpp"

namespace ukemi::tools {

DrivenRobot robot_of(const std::string& path, Run& run);
/// Of its files by their columns and pieces; what else is read of a log says `reading`.
std::vector<RobotTrial> read_trials(const LogArguments& logs, RobotLogOptions reading, const DrivenRobot& robot,
                                    Run& run);

}  // namespace ukemi::tools

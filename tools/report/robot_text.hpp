// Writes the file of a robot of links with changed constants; what is not changed keeps its text.
#pragma once

#include <string>
#include <vector>

#include "tools/study/robot_trials.hpp"

namespace ukemi::tools {

/// Text of the robot's file with `values` of constants by the names of robot_terms, `comments` first, [identified] as
/// `robot` has it. `folder`: where the text will be saved, for relative paths. Throws InputError where the file's
/// notation is not supported, or a drive has a file of its own.
std::string robot_text(const std::string& path, const DrivenRobot& robot,
                       const std::vector<std::pair<std::string, double>>& values, const std::string& comments,
                       const std::string& folder);

}  // namespace ukemi::tools

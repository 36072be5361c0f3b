// A robot of links with other constants, as a file: what was read, with these values.
#pragma once

#include <string>
#include <vector>

#include "tools/study/robot_trials.hpp"

namespace ukemi::tools {

/// The text of a robot's file with constants at their values, by the names of robot_terms; what is not changed stays as
/// it is written, `comments` go in front; [identified] is what is known of `robot`. `folder`: where it will stand, for
/// the paths in it. Throws InputError where the file is written in a way that cannot be followed, or a drive stands in
/// a file of its own.
std::string robot_text(const std::string& path, const DrivenRobot& robot,
                       const std::vector<std::pair<std::string, double>>& values, const std::string& comments,
                       const std::string& folder);

}  // namespace ukemi::tools

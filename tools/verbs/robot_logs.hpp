// Reading of a robot of links and its logs; both become inputs of the run.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "tools/study/robot_trials.hpp"
#include "tools/verbs/runs.hpp"

namespace ukemi::tools {

/// Adds --pieces and --tie.
void add_pieces(CLI::App& verb, std::string& pieces, int& tie);
/// Throws InputError where they are given; for calls without --robot.
void check_no_pieces(const std::string& pieces, int tie);
/// How angles are read, see --multi-turn.
RobotLogOptions reading_of(const TrialArguments& arguments);
DrivenRobot robot_of(const std::string& path, Run& run);
/// Reads the trials of logs; `reading` has the options other than columns, pieces and tie.
std::vector<RobotTrial> read_trials(const LogArguments& logs, RobotLogOptions reading, const DrivenRobot& robot,
                                    Run& run);

}  // namespace ukemi::tools

// The results of `ukemi design` as they are written.
#pragma once

#include <string>

#include "tools/program/output.hpp"
#include "tools/study/experiment.hpp"
#include "tools/study/robot_design.hpp"

namespace ukemi::tools {

extern const Outputs kDesignOutputs;

/// "± 3.2 %", "not determined".
std::string half_width_words(double relative);
/// Adds to a summary that holds what was read, writes the files, returns the exit code.
int report(const DesignQuestion& question, const DesignAnswer& answer, Json summary, Run& run);

/// The same of a robot of links.
int report(const RobotDesign& design, Run& run);

}  // namespace ukemi::tools

// Reports of `ukemi design`.
#pragma once

#include "tools/program/output.hpp"
#include "tools/study/experiment.hpp"
#include "tools/study/robot_design.hpp"

namespace ukemi::tools {

extern const Outputs kDesignOutputs;

/// Completes `summary`, which holds what was read, and writes the files. Returns the exit code.
int report(const DesignQuestion& question, const DesignAnswer& answer, Json summary, Run& run);

/// Design of trials for a robot of links.
int report(const RobotDesign& design, Run& run);

}  // namespace ukemi::tools

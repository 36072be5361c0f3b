// The results of `ukemi design` as they are written.
#pragma once

#include "tools/program/output.hpp"
#include "tools/study/experiment.hpp"

namespace ukemi::tools {

extern const Outputs kDesignOutputs;

/// Adds to a summary that holds what was read, writes the files, returns the exit code.
int report(const DesignQuestion& question, const DesignAnswer& answer, Json summary, Run& run);

}  // namespace ukemi::tools

// What `ukemi compare` tells.
#pragma once

#include "tools/program/output.hpp"
#include "tools/study/comparison.hpp"

namespace ukemi::tools {

struct CompareQuestion {
  OfSets<Actuator> sets;
  std::optional<RigTrials> measured;
  std::optional<landing::Scene> scene;
  ComparisonOptions options;
};

/// Adds to a summary that holds what was read, writes the files, returns the exit code.
int report(const CompareQuestion& question, const Comparison& comparison, Json summary, Run& run);

}  // namespace ukemi::tools

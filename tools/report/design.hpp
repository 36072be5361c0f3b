// The results of `ukemi design` as they are written.
#pragma once

#include <optional>
#include <vector>

#include "identify/design/design.hpp"
#include "tools/program/output.hpp"

namespace ukemi::tools {

struct DesignQuestion {
  identify::Rig rig;
  identify::Knowledge knowledge;
  std::vector<identify::Trial> trials;  ///< that the knowledge comes from; none: the actuator's covariance
  identify::DesignOptions options;
};
struct DesignAnswer {
  identify::Design design;
  std::optional<identify::DesignCheck> check;
};

/// Adds to a summary that holds what was read, writes the files, returns the exit code.
int report(const DesignQuestion& question, const DesignAnswer& answer, Json summary, Run& run);

}  // namespace ukemi::tools

// Defects of logs that need no model: short pulses, gaps, a force whose sign is flipped.
#pragma once

#include <string>
#include <vector>

#include "identify/logs/trial.hpp"

namespace ukemi::identify {

struct LogCheck {
  bool flawed = false;  ///< a gap in a hit, or a force of the wrong sign
  std::vector<std::string> warnings;
};
[[nodiscard]] LogCheck check_logs(const std::vector<Trial>& trials);

}  // namespace ukemi::identify

#include "tools/program/actuators.hpp"

#include <fmt/format.h>

namespace ukemi::tools {

Actuator actuator_of(const std::string& path, Run& run) {
  Actuator actuator = read_actuator(path);
  run.input(path);
  std::string doubts;
  for (const auto& [constant, verdict] : actuator.verdicts)
    if (verdict != "trusted" && verdict != "fixed")
      doubts += fmt::format("{}{} is {}", doubts.empty() ? "" : ", ", constant, verdict);
  if (!doubts.empty())
    run.warn(fmt::format("{}: not trusted by the fit that wrote it: {}; what follows rests on it", path, doubts));
  return actuator;
}

}  // namespace ukemi::tools

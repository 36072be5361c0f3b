// Arguments of design, of a rig or of a robot of links.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/program/trials.hpp"
#include "tools/study/experiment.hpp"

namespace ukemi::tools {

struct DesignArguments {
  std::vector<std::string> trials, next;  ///< existing trials; of a robot, logs of commands to choose from
  std::string rig, actuator, robot, pieces, free, heights;
  identify::Criterion criterion = identify::Criterion::kWorst;
  TrialArguments reading;
  identify::HitBudget budget;
  std::vector<double> width = {0.010, 0.020};
  identify::HitLog log;
  std::string noise;  ///< [rad]; of a robot CHANNEL=STD,...
  std::optional<double> tau_max;
  int hits = 2, check = 50, tie = 1;
  std::vector<std::string> given;  ///< names of the options on the command line
};
/// Chooses which of `next` to log.
int design_robot(const DesignArguments& arguments, const CommonOptions& common);

}  // namespace ukemi::tools

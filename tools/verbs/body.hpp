// What simulate, optimize and risk do with a robot of links, and the verb that shows one.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/verbs/runs.hpp"

namespace ukemi::tools {

/// The one file of --actuator that the paper's robot has. Throws InputError where there is none, or more.
std::string only_actuator(const std::vector<std::string>& given);

struct SimulateArguments {
  std::string scene, drop_from;
  std::vector<std::string> actuators;
  MotionArguments motion;
  std::optional<double> rate, accuracy;
  Exports exports;
};
struct RiskArguments {
  std::string scene;
  std::vector<std::string> actuators;
  MotionArguments motion;
  ScatterArguments scatter;
  std::optional<long> samples;
  enum class Execution { kExact, kInexact } execution = Execution::kExact;
  std::vector<std::string> forbid;
};
/// Their --samples, checked.
long samples_of(const RiskArguments& arguments);
/// Whether a scene's robot is in the long form; the file is an input of the run.
bool is_body(const std::string& scene);
int simulate_body(const SimulateArguments& arguments, const CommonOptions& common);
int risk_body(const RiskArguments& arguments, const CommonOptions& common);
int optimize_body(const OptimizeArguments& arguments, const CommonOptions& common);

}  // namespace ukemi::tools

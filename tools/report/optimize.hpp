// What `ukemi optimize` tells.
#pragma once

#include <map>
#include <string>

#include "landing/judge/answer.hpp"
#include "tools/program/output.hpp"

namespace ukemi::tools {

/// What was asked for, and the rows of motion.csv a second.
struct OptimizeQuestion {
  landing::Scene scene;
  Actuator actuator;
  landing::AnswerOptions options;
  double rate = 1000;
};

/// Every file but the summary.
std::map<std::string, std::string> files_of(const OptimizeQuestion& question, const landing::Answer& answer,
                                            const Run& run);
/// Tells it on the terminal, in the summary and in the files; returns the exit code.
int report(const OptimizeQuestion& question, const landing::Answer& answer, Run& run);

}  // namespace ukemi::tools

// What `ukemi identify` and `ukemi predict` tell.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/actuator.hpp"
#include "tools/program/output.hpp"
#include "tools/report/trust.hpp"

namespace ukemi::tools {

struct IdentifyQuestion {
  enum class Verb { kIdentify, kPredict } verb = Verb::kIdentify;
  identify::Rig rig;
  std::vector<identify::Trial> trials;
  identify::FitOptions options;
  std::optional<Actuator> given;  ///< to start from, to predict with
  SeaParameters<double> base;     ///< what is not fitted: limit, feedback, friction
  bool found(const identify::Fit& fit) const { return verb == Verb::kPredict || !fit.fitted.empty(); }
};

/// The actuator as its file holds it: constants, verdicts, covariance, ratings.
Actuator actuator_of(const IdentifyQuestion& question, const identify::Fit& fit);

/// Adds to a summary that holds what was read, writes the files, returns the exit code.
int report(const IdentifyQuestion& question, const identify::Fit& fit, const std::optional<Trust>& trust, Doubt doubt,
           Json summary, Run& run);

}  // namespace ukemi::tools

// Design of the next experiment on a rig: the hits that add most to the knowledge of an actuator's constants, and
// simulated experiments that test the prediction. No printing, no files: tools/verbs/design.cpp is the verb.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "identify/design/design.hpp"

namespace ukemi::tools {

/// Every criterion by its name.
inline std::vector<std::pair<std::string, identify::Criterion>> criteria() {
  std::vector<std::pair<std::string, identify::Criterion>> out;
  for (const auto c : {identify::Criterion::kWorst, identify::Criterion::kD, identify::Criterion::kE})
    out.emplace_back(name(c), c);
  return out;
}

struct DesignQuestion {
  identify::Rig rig;
  identify::Knowledge knowledge;
  std::vector<identify::Trial> trials;  ///< sources of the knowledge; none: the actuator's covariance
  identify::DesignOptions options;
};
struct DesignAnswer {
  identify::Design design;
  std::optional<identify::DesignCheck> check;
};

/// The input of a design; absent values are taken from the trials or the actuator.
struct DesignRequest {
  identify::Rig rig;
  Actuator actuator;                    ///< the present estimate
  std::vector<identify::Trial> trials;  ///< that exist already
  identify::DesignOptions options;      ///< noise and outputs of its log are set by design_question
  std::optional<double> noise;          ///< standard deviation of an angle [rad], > 0; absent: the trials'
  std::optional<double> tau_max;        ///< torque limit of the spring [Nm]; absent: the rig's, else the actuator's
  /// Names of the arguments in messages.
  std::string rig_name = "rig", actuator_name = "actuator", noise_name = "noise";
};

/// Throws InputError where the drive follows a logged command, the noise is not known, or no constant is uncertain.
[[nodiscard]] DesignQuestion design_question(const DesignRequest& request);
/// Reasons to doubt the knowledge, a sentence each.
[[nodiscard]] std::vector<std::string> design_doubts(const DesignQuestion& question);
/// The hits and, with `checks` > 0, that many simulated experiments that test them.
[[nodiscard]] DesignAnswer answer(const DesignQuestion& question, int checks);

}  // namespace ukemi::tools

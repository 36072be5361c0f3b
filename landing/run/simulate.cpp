#include "landing/run/simulate.hpp"

#include "common/checks.hpp"
#include "common/csv.hpp"
#include "common/error.hpp"

namespace ukemi::landing {

const char* name(End end) {
  switch (end) {
    case End::kRest:
      return "rest";
    case End::kTimeLimit:
      return "t_end";
    case End::kNoContact:
      return "no contact";
    case End::kAbandoned:
      return "abandoned";
    case End::kStopped:
      return "stopped";
    case End::kBroken:
      return "limit broken";
    case End::kFailed:
      return "failed";
  }
  return "?";
}

const char* reason(const RunEnd& run) {
  switch (run.failure) {
    case Failure::kNone:
      return "it did not fail";
    case Failure::kIntegration:
      return name(run.status);
    case Failure::kSteps:
      return "the run needs more steps than are allowed (is the scene stiff?)";
    case Failure::kUnresolved:
      return "the acceleration inside a step is far above its ends: the steps do not resolve it";
    case Failure::kGivesWay:
      return "the spring softens until it no longer resists (k_sea_cubic)";
    case Failure::kUnbalanced:
      return "the energy balance does not close";
  }
  return "?";
}

void Limits::validate() const {
  const auto check = [](const char* what, double limit) {
    if (!(limit >= 0))
      throw InputError(std::string("limits.") + what + ": " + shortest(limit) + ": at least 0 is needed");
  };
  check("motor_speed", motor_speed), check("motor_torque", motor_torque), check("reference_rate", reference_rate);
  if (!(joint[0] < joint[1]))
    throw InputError("limits.joint: " + shortest(joint[0]) + " to " + shortest(joint[1]) +
                     ": numbers that rise are needed");
}

void SimulateOptions::validate() const {
  if (!(accuracy >= 1e-14 && accuracy <= 1e-2))
    throw InputError("accuracy: " + shortest(accuracy) + ": a relative tolerance from 1e-14 to 1e-2 is needed");
  if (!(max_step > 0)) throw InputError("max_step: " + shortest(max_step) + ": above 0 is needed");
  if (max_steps < 1) throw InputError("max_steps: " + std::to_string(max_steps) + ": at least 1 is needed");
  if (!(abandon_above >= 0)) throw InputError("abandon_above: " + shortest(abandon_above) + ": at least 0 is needed");
  limits.validate();
}

void validate(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion) {
  scene.validate(), validate(sea), validate(motion);
}

}  // namespace ukemi::landing

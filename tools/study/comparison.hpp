// Comparison of two sets of an actuator's constants, nominal and identified: differences, predictions of the trials,
// and the effect on the best landing.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "common/actuator.hpp"
#include "identify/fit/fit.hpp"
#include "landing/judge/under_scatter.hpp"
#include "landing/search/optimize.hpp"
#include "tools/study/compared.hpp"

namespace ukemi::tools {

/// The comparison for the paper's robot.
using ComparedMotion = ComparedMotionOf<landing::Optimum, landing::Landing>;
using ComparedPlan = ComparedPlanOf<landing::Optimum, landing::UnderScatter>;

/// Trials and their rig; its torque limit and feedback override the actuators'.
struct RigTrials {
  identify::Rig rig;
  std::vector<identify::Trial> trials;
};

struct Comparison {
  PerSet<Actuator> sets;
  std::optional<RigTrials> measured;
  std::optional<landing::Scene> scene;
  std::vector<ConstantDifference> constants;
  std::optional<PerSet<identify::Fit>> predictions;  ///< of the trials, if any
  std::vector<ComparedMotion> motions;               ///< of both sets, if there is a scene
  std::vector<ComparedPlan> plans;                   ///< if plans for scatter are requested
  bool complete = true;  ///< every rollout, search and landing succeeded and none was stopped

  bool landed() const { return all_landed(motions); }
};

struct ComparisonOptions {
  double escape = std::numeric_limits<double>::infinity();  ///< see identify::FitOptions::escape
  landing::OptimizeOptions search;
  landing::RobustOptions robust;                       ///< with a measure also plans for drops that scatter
  std::function<Monitor(const std::string&)> monitor;  ///< of the search with the set of the given name
  double rate = 1000;                                  ///< rows of the trajectories a second [Hz]
};

/// Compares as far as trials and a scene are given. Does not throw on numerical failure: the result ends with the first
/// motion that could not be found or simulated.
[[nodiscard]] Comparison compare(const PerSet<Actuator>& sets, const std::optional<RigTrials>& measured,
                                 const std::optional<landing::Scene>& scene, const ComparisonOptions& options = {});

}  // namespace ukemi::tools

// Two sets of an actuator's constants side by side, nominal and identified: what differs, how each predicts the trials,
// and what the difference does to the best landing.
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

/// Trials as the rig measured them; the rig's torque limit and feedback count before the actuators'.
struct RigTrials {
  identify::Rig rig;
  std::vector<identify::Trial> trials;
};

struct Comparison {
  OfSets<Actuator> sets;
  std::optional<RigTrials> measured;
  std::optional<landing::Scene> scene;
  std::vector<ConstantDifference> constants;
  std::optional<OfSets<identify::Fit>> predictions;  ///< of the trials, where there are any
  std::vector<ComparedMotion> motions;               ///< where there is a scene: of both sets
  std::vector<ComparedPlan> plans;                   ///< where plans for scatter are requested
  bool complete = true;  ///< every rollout, search and landing worked out and none was stopped

  bool landed() const { return all_landed(motions); }
};

struct ComparisonOptions {
  double escape = std::numeric_limits<double>::infinity();  ///< see identify::FitOptions::escape
  landing::OptimizeOptions search;
  landing::RobustOptions robust;                       ///< with a measure: plans for scatter, too
  std::function<Monitor(const std::string&)> monitor;  ///< of the search with the set of this name
  double rate = 1000;                                  ///< rows of the trajectories a second [Hz]
};

/// Compares on whatever is given. Numbers that do not work out are in the result: it ends with the first motion that
/// could not be found or landed.
[[nodiscard]] Comparison compare(const OfSets<Actuator>& sets, const std::optional<RigTrials>& measured,
                                 const std::optional<landing::Scene>& scene, const ComparisonOptions& options = {});

}  // namespace ukemi::tools

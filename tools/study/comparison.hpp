// Two sets of an actuator's constants side by side, nominal and identified: what differs, how each predicts the trials,
// and what the difference does to the best landing.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/actuator.hpp"
#include "identify/fit/fit.hpp"
#include "landing/judge/under_scatter.hpp"
#include "landing/search/optimize.hpp"

namespace ukemi::tools {

inline constexpr std::array<const char*, 2> kSets = {"nominal", "identified"};
template <class T>
using OfSets = std::array<T, 2>;  ///< nominal, identified

struct ConstantDifference {
  std::string name, unit;
  OfSets<double> value;
  std::optional<double> std;  ///< standard error of the identified one

  double difference() const { return value[1] - value[0]; }
  double percent() const { return 100 * difference() / value[0]; }
  std::optional<double> z() const;     ///< difference in standard errors
  std::optional<bool> inside() const;  ///< the nominal value lies in the identified one's 95 % interval
};

/// A set's best motion, landed under both actuators.
struct ComparedMotion {
  std::string set;  ///< whose best it is
  landing::Optimum best;
  OfSets<std::optional<landing::Landing>> landings;  ///< absent where it was stopped before
};

/// A plan for drops that scatter, and what it comes to where the identified constants are the truth.
struct ComparedPlan {
  std::string set;  ///< "nominal", "identified", "identified, with its covariance"
  landing::Optimum best;
  landing::UnderScatter truth;
};

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
  std::vector<ComparedPlan> plans;                   ///< where plans for scatter are asked for
  bool complete = true;  ///< every rollout, search and landing worked out and none was stopped

  bool landed() const { return motions.size() == 2 && motions[1].landings[1]; }  ///< all four landings were played
};

struct ComparisonOptions {
  double escape = identify::Term::kInfinity;  ///< see identify::FitOptions::escape
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

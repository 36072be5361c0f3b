// Two sets of the drives' constants of a robot of links side by side, and what the difference does to its best landing.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "landing/plan/body_plan.hpp"
#include "tools/study/compared.hpp"

namespace ukemi::tools {

using ComparedBodyMotion = ComparedMotionOf<landing::BodyPlan, landing::BodyLanding>;
using ComparedBodyPlan = ComparedPlanOf<landing::BodyPlan, landing::Distribution>;

struct BodyComparison {
  OfSets<landing::BodyScene> scenes;          ///< one scene with the drives of each set
  std::vector<ConstantDifference> constants;  ///< k_p_JOINT ...: of the drives that differ, of all where none does
  std::vector<ComparedBodyMotion> motions;
  std::vector<ComparedBodyPlan> plans;  ///< where there is a measure
  bool complete = true;                 ///< every search and landing worked out and none was stopped

  bool landed() const { return all_landed(motions); }
};

struct BodyComparisonOptions {
  landing::BodyPlanOptions search;                     ///< with a measure: plans for scatter, too
  std::function<Monitor(const std::string&)> monitor;  ///< of the search with the set of this name
  double rate = 1000;                                  ///< rows of the trajectories a second [Hz]
};

/// Throws InputError where the scenes differ in a number of the design that is no drive's, or in what a plan may be.
void check_sets(const OfSets<landing::BodyScene>& scenes);

/// Compares the drives of two scenes that have all else in common. Numbers that do not work out are in the result: it
/// ends with the first motion that could not be found or landed. Tests: test/cli/links_compared.cpp.
[[nodiscard]] BodyComparison compare(const OfSets<landing::BodyScene>& scenes,
                                     const BodyComparisonOptions& options = {});

}  // namespace ukemi::tools

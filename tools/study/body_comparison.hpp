// Comparison of two sets of the drives' constants of a robot of links, and their effect on its best landing.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "landing/plan/body_plan.hpp"
#include "tools/study/compared.hpp"

namespace ukemi::tools {

using ComparedBodyMotion = ComparedMotionOf<landing::BodyPlan, landing::BodyLanding>;
using ComparedBodyPlan = ComparedPlanOf<landing::BodyPlan, landing::Distribution>;

struct BodyComparison {
  PerSet<landing::BodyScene> scenes;          ///< the same scene with the drives of each set
  std::vector<ConstantDifference> constants;  ///< k_p_JOINT, ...: of the drives that differ, or of all where none does
  std::vector<ComparedBodyMotion> motions;
  std::vector<ComparedBodyPlan> plans;  ///< with options.search.measure only
  bool complete = true;                 ///< every search and landing succeeded and none was stopped

  bool landed() const { return all_landed(motions); }
};

struct BodyComparisonOptions {
  landing::BodyPlanOptions search;                     ///< with a measure also plans for drops that scatter
  std::function<Monitor(const std::string&)> monitor;  ///< of the search with the set of the given name
  double rate = 1000;                                  ///< rows of the trajectories a second [Hz]
  /// Drops as they were measured, with the drives of each set, instead of drawn ones; as BodyPlanOptions::measured.
  PerSet<std::shared_ptr<const std::vector<landing::BodyDrop>>> measured;
};

/// Throws InputError where the scenes differ in a design number other than of a drive, or in a variable of the search.
void check_sets(const PerSet<landing::BodyScene>& scenes);

/// Compares two scenes that differ in their drives only. Does not throw on numerical failure: the result ends with the
/// first motion that could not be found or simulated. Tests: test/cli/links_compared.cpp.
[[nodiscard]] BodyComparison compare(const PerSet<landing::BodyScene>& scenes,
                                     const BodyComparisonOptions& options = {});

}  // namespace ukemi::tools

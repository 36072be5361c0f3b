// Where no motion of a robot of links keeps its limits: the one that breaks them least.
#pragma once

#include <optional>

#include "landing/plan/body_plan.hpp"

namespace ukemi::landing {

struct BodyLeastBreaking {
  BodyMotion motion;
  Load limit;                                              ///< that it breaks most
  double demand;                                           ///< what the limit has to bear, in its unit
  double excess() const { return demand / limit.rating; }  ///< [1]
};

/// A small search makes the largest value / rating over the limits small in the execution box. Those with a rating of
/// 0, and rates of references, stay limits: absent where they cannot be kept, or where it is one of them that no motion
/// keeps. Of the options accuracy, seed, threads and monitor count.
[[nodiscard]] std::optional<BodyLeastBreaking> least_breaking(const BodyScene& scene, const BodyPlanOptions& options);

}  // namespace ukemi::landing

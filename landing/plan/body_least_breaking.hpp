// The motion of a robot of links that exceeds the limits least, where none keeps them.
#pragma once

#include <optional>

#include "landing/plan/body_plan.hpp"

namespace ukemi::landing {

struct BodyLeastBreaking {
  BodyMotion motion;
  Load limit;                                              ///< that it exceeds most
  double demand;                                           ///< largest value of the load, in its unit
  double excess() const { return demand / limit.rating; }  ///< [1]
};

/// A small search minimises the largest value / rating over the limits in the execution box. Limits with a rating of 0
/// and rates of references must be kept: absent where no motion does, or where the others are kept too. Uses accuracy,
/// seed, threads and monitor of the options.
[[nodiscard]] std::optional<BodyLeastBreaking> least_breaking(const BodyScene& scene, const BodyPlanOptions& options);

}  // namespace ukemi::landing

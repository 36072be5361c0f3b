// One landing with everything that says how far it can be relied on.
#pragma once

#include "landing/judge/ratings.hpp"
#include "landing/judge/sensitivity.hpp"

namespace ukemi::landing {

struct CheckedLanding {
  Motion motion{};
  double accuracy = 0;  ///< of the landing
  Landing landing;
  Sensitivity sensitivity;
  Ratings ratings;
  std::optional<Instability> instability;

  /// The peak moves with the tolerance and not with the scene: it is not that of the motion.
  bool wrong() const { return sensitivity.checked && !sensitivity.right && landing.end != End::kFailed; }
  /// The joint turns by more than two turns: the drive does not hold it.
  bool joint_lost() const { return landing.demands.phi_max - landing.demands.phi_min > 4 * 3.141592653589793; }
};

/// As `simulate`, with rate > 0 [Hz] a trajectory too.
[[nodiscard]] CheckedLanding checked_landing(const Scene& scene, const Actuator& actuator, const Motion& motion,
                                             const SimulateOptions& options = {}, double rate = 0);

}  // namespace ukemi::landing

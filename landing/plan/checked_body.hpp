// One landing of a robot of links, and how far its peak can be trusted.
#pragma once

#include "landing/body/body_run.hpp"
#include "landing/body/body_stability.hpp"
#include "landing/judge/sensitivity.hpp"

namespace ukemi::landing {

struct CheckedBody {
  BodyScene scene;
  BodyMotion motion;
  BodyLanding landing;
  Sensitivity sensitivity;
  double accuracy;
  /// The peak changes with the tolerance and not with the scene.
  bool wrong() const { return sensitivity.checked && !sensitivity.right; }
};

/// The landing, then at a hundredth of the tolerance, then the latter on `draws` scenes with masses, inertias, floor
/// and drop perturbed by +-1e-6 relative at random; as `sensitivity` of the paper's robot.
[[nodiscard]] CheckedBody checked_body(const BodyScene& scene, const BodyMotion& motion,
                                       const SimulateOptions& options = {}, double rate = 0, int draws = 4);
/// The landing of the held posture in the same drop at the same accuracy, for comparison; absent where the motion holds
/// it, or it cannot be followed.
[[nodiscard]] std::optional<BodyLanding> held_landing(const CheckedBody& checked, double rate);

}  // namespace ukemi::landing

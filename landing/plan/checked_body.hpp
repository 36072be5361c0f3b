// One landing of a robot of any joints, and how far its peak can be relied on.
#pragma once

#include "landing/body/body_run.hpp"
#include "landing/judge/sensitivity.hpp"

namespace ukemi::landing {

struct CheckedBody {
  BodyScene scene;
  BodyMotion motion;
  BodyLanding landing;
  Sensitivity sensitivity;
  double accuracy;
  /// The peak moves with the tolerance and not with the scene.
  bool wrong() const { return sensitivity.checked && !sensitivity.right; }
};

/// The landing, then again at a hundredth of the tolerance, then that on `draws` scenes whose masses, inertias, floor
/// and drop are moved by 1e-6 relative, up or down at random; as `sensitivity` of the paper's robot.
[[nodiscard]] CheckedBody checked_body(const BodyScene& scene, const BodyMotion& motion,
                                       const SimulateOptions& options = {}, double rate = 0, int draws = 4);
/// The landing of the held posture on the same drop, as exact, to stand beside it; none where nothing moves, or it
/// cannot be followed.
[[nodiscard]] std::optional<BodyLanding> held_beside(const CheckedBody& checked, double rate);

}  // namespace ukemi::landing

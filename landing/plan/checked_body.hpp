// One landing of a robot of any joints, and how far its peak can be relied on.
#pragma once

#include "landing/body/body_run.hpp"
#include "landing/judge/sensitivity.hpp"

namespace ukemi::landing {

/// Drives that do not bring the robot to rest in flight, see `growth`.
struct BodyInstability {
  double rate;   ///< of what grows [1/s], > 0
  int joint;     ///< of Robot::joints, whose rates are the largest in it
  bool landing;  ///< at phi_F with the landing gains; else at phi_I
};
/// The faster one of both ends of a motion, as if nothing weighed and no torque were limited; absent: at rest by
/// itself.
[[nodiscard]] std::optional<BodyInstability> instability(const BodyScene& scene, const BodyMotion& motion);

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

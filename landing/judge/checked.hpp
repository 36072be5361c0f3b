// One landing with the checks of its peak, and its demands on the actuator.
#pragma once

#include <optional>

#include "common/actuator.hpp"
#include "landing/judge/sensitivity.hpp"

namespace ukemi::landing {

/// Demands of a motion on the actuator, and the actuator's ratings.
struct Ratings {
  double reference_rate = 0;               ///< largest |dphi_ref| of the motion [rad/s]
  Demands demands;                         ///< of the landing
  std::optional<double> speed_max;         ///< rated motor speed [rad/s]
  std::optional<double> motor_torque_max;  ///< rated motor torque [Nm]
  double tau_max = 0;                      ///< limit of the spring's torque [Nm]; infinite: none

  bool too_fast() const { return speed_max && (reference_rate > *speed_max || demands.motor_speed > *speed_max); }
  bool too_strong() const { return motor_torque_max && demands.motor_torque > *motor_torque_max; }
};
[[nodiscard]] Ratings ratings(const Scene& scene, const Actuator& actuator, const Motion& motion,
                              const Landing& landing);

/// A drive that is unstable in flight, see growth_rate.
struct Instability {
  double phi;   ///< joint angle of the faster growth [rad]: phi_I or phi_F
  double rate;  ///< growth rate there [1/s], > 0
};
[[nodiscard]] std::optional<Instability> instability(const Scene& scene, const SeaParameters<double>& sea,
                                                     const Motion& motion);

struct CheckedLanding {
  Scene scene;
  Motion motion{};
  double accuracy = 0;
  Landing landing;
  Sensitivity sensitivity;
  Ratings ratings;
  std::optional<Instability> instability;

  /// The peak changes with the tolerance and not with the scene: it is wrong.
  bool wrong() const { return sensitivity.checked && !sensitivity.right && landing.end != End::kFailed; }
};
/// As `simulate`, with rate > 0 [Hz] a trajectory too.
[[nodiscard]] CheckedLanding checked_landing(const Scene& scene, const Actuator& actuator, const Motion& motion,
                                             const SimulateOptions& options = {}, double rate = 0);
/// The landing of kHeld (under_scatter.hpp) in the same drop at the same accuracy, for comparison; absent where the
/// motion is kHeld, or it cannot be followed.
[[nodiscard]] std::optional<Landing> held_landing(const CheckedLanding& checked, const SeaParameters<double>& sea,
                                                  double rate);

}  // namespace ukemi::landing

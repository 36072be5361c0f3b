// What a motion demands of the actuator, beside what the actuator can give, and whether its drive is stable.
#pragma once

#include <optional>

#include "common/actuator.hpp"
#include "landing/run/simulate.hpp"

namespace ukemi::landing {

struct Ratings {
  double reference_rate = 0;        ///< largest |dphi_ref| of the motion [rad/s]
  Demands demands;                  ///< of its landing
  std::optional<double> speed_max;  ///< rated motor speed [rad/s]
  double tau_max = 0;               ///< torque limit [Nm]; infinite: none

  bool too_fast() const { return speed_max && (reference_rate > *speed_max || demands.motor_speed > *speed_max); }
  bool too_strong() const { return demands.motor_torque > tau_max; }
};
[[nodiscard]] Ratings ratings(const Actuator& actuator, const Motion& motion, const Landing& landing);

/// A drive that does not come to rest on the robot in flight, see growth_rate.
struct Instability {
  double phi;   ///< joint angle at which it is worst [rad]
  double rate;  ///< of growth there [1/s], > 0
};
/// At the two angles that the motion holds.
[[nodiscard]] std::optional<Instability> instability(const Scene& scene, const SeaParameters<double>& sea,
                                                     const Motion& motion);

}  // namespace ukemi::landing

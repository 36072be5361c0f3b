// One landing of a robot of any joints, from event to event.
#pragma once

#include <vector>

#include "landing/run/simulate.hpp"
#include "test/legs/leg_scene.hpp"

namespace ukemi::landing {

struct LegLanding {
  double peak = 0, t_peak = 0, t_end = 0;
  End end = End::kFailed;
  integrate::Status status = integrate::Status::kStepped;
  integrate::Counters work;
  double first = std::numeric_limits<double>::infinity();   ///< touchdown [s]
  std::vector<int> contacts;                                ///< in the order of their touchdowns
  std::vector<double> times;                                ///< of them [s]
  double last_liftoff = 0;                                  ///< [s]
  double base_x = 0, base_y = 0, base_vx = 0, base_vy = 0;  ///< at the end: centre of mass of a free robot, else s
};

/// Follows one landing to t_end, or 10 s after the first touchdown.
[[nodiscard]] LegLanding land(const LegScene& scene, const LegMotion& motion, double accuracy = 1e-9);

}  // namespace ukemi::landing

#include "landing/judge/checked.hpp"

namespace ukemi::landing {

CheckedLanding checked_landing(const Scene& scene, const Actuator& actuator, const Motion& motion,
                               const SimulateOptions& options, double rate) {
  CheckedLanding out{.motion = motion, .accuracy = options.accuracy};
  out.landing = simulate(scene, actuator.sea, motion, options, rate);
  out.sensitivity = sensitivity(scene, actuator.sea, motion, options, out.landing.peak);
  out.ratings = ratings(actuator, motion, out.landing);
  out.instability = instability(scene, actuator.sea, motion);
  return out;
}

}  // namespace ukemi::landing

#include "landing/body/body_kernel.hpp"
#include "landing/run/simulate.hpp"

namespace ukemi::landing {

BodyLanding peak_acceleration(const BodyScene& scene, const BodyMotion& motion, const SimulateOptions& options) {
  if (options.accuracy < kLowOrder) return simulate(scene, motion, options);
  scene.validate(), validate(scene.robot, motion), options.validate();
  return in_landing_kernel(scene.robot,
                           [&]<Capacity kSize>() { return peak_in_kernel<kSize>(scene, motion, options); });
}

}  // namespace ukemi::landing

#include "landing/body/body_kernel.hpp"

namespace ukemi::landing {

BodyLanding peak_acceleration(const BodyScene& scene, const BodyMotion& motion, const SimulateOptions& options) {
  scene.validate(), validate(scene.robot, motion), options.validate();
  return in_peak_kernel(scene.robot, [&]<Capacity kSize>() { return peak_in_kernel<kSize>(scene, motion, options); });
}

}  // namespace ukemi::landing

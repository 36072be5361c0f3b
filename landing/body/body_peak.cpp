#include "common/error.hpp"
#include "landing/body/body_kernel.hpp"
#include "landing/run/simulate.hpp"

namespace ukemi::landing {

BodyLanding peak_of_valid(const BodyScene& scene, const BodyMotion& motion, const SimulateOptions& options) {
  if (options.method != Method::kAuto) {
    if (!fits(scene.robot, kPair) && !fits(scene.robot, kLateLeg))
      throw InputError(std::string("method: ") + integrate::name(options.method) +
                       ": methods are compared on robots of two links");
    return peak_by_method(scene, motion, options);
  }
  return in_peak_kernel(scene.robot, [&]<Capacity kSize>() { return peak_in_kernel<kSize>(scene, motion, options); });
}

BodyLanding peak_acceleration(const BodyScene& scene, const BodyMotion& motion, const SimulateOptions& options) {
  scene.validate(), validate(scene.robot, motion), options.validate();
  return peak_of_valid(scene, motion, options);
}

}  // namespace ukemi::landing

// The fast path: nothing but the peak, in the smallest kernel that holds the robot.
#include "common/integrate/tableaus.hpp"
#include "landing/body/body_follow.hpp"

namespace ukemi::landing {

BodyLanding peak_acceleration(const BodyScene& scene, const BodyMotion& motion, const SimulateOptions& options) {
  if (options.accuracy < kLowOrder) return simulate(scene, motion, options);
  scene.validate(), validate(scene.robot, motion), options.validate();
  BodyLanding out;
  const auto with = [&]<Capacity kSize>() {
    BodyFollower<integrate::DormandPrince54, kSize, false>(scene, motion, options, out, 0).follow();
  };
  if (fits(scene.robot, kSmall))
    with.template operator()<kSmall>();
  else if (fits(scene.robot, kMiddle))
    with.template operator()<kMiddle>();
  else
    with.template operator()<kAny>();
  return out;
}

}  // namespace ukemi::landing

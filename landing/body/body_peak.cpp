// The fast path: nothing but the peak, in the smallest kernel that holds the robot.
#include "common/integrate/tableaus.hpp"
#include "landing/body/body_follow.hpp"

namespace ukemi::landing {

BodyLanding peak_acceleration(const BodyScene& scene, const BodyMotion& motion, const SimulateOptions& options) {
  constexpr double kLowOrder = 1e-7;  // as the paper's robot, landing/run/kernels.hpp
  if (options.accuracy < kLowOrder) return simulate(scene, motion, options);
  scene.validate(), validate(scene.robot, motion), options.validate();
  BodyLanding out;
  const auto with = [&]<Capacity kSize>() {
    BodyFollower<integrate::DormandPrince54, kSize, false>(scene, motion, options, out, 0).follow();
  };
  const std::size_t links = scene.robot.links.size(), joints = scene.robot.joints.size(),
                    contacts = scene.robot.contacts.size();
  const auto fits = [&](const Capacity& c) {
    return links <= std::size_t(c.bodies) && joints <= std::size_t(c.joints) && contacts <= std::size_t(c.contacts);
  };
  constexpr Capacity kSmall{3, 2, 4}, kMiddle{5, 4, 7}, kAny{kMostLinks, kMostJoints, kMostContacts};
  if (fits(kSmall))
    with.template operator()<kSmall>();
  else if (fits(kMiddle))
    with.template operator()<kMiddle>();
  else
    with.template operator()<kAny>();
  return out;
}

}  // namespace ukemi::landing

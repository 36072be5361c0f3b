#include "landing/judge/checked.hpp"

#include "landing/body/body_stability.hpp"
#include "landing/body/by_links.hpp"
#include "landing/judge/under_scatter.hpp"

namespace ukemi::landing {

Ratings ratings(const Scene& scene, const Actuator& actuator, const Motion& motion, const Landing& landing) {
  return {peak_reference_rate(motion, landing.contacts.first() + scene.detection_delay), landing.demands,
          actuator.speed_max, actuator.motor_torque_max, actuator.sea.tau_max};
}

std::optional<Instability> instability(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion) {
  const TwoLinkLanding links(scene, sea, motion);
  const std::optional<BodyInstability> found = instability(links.scene, links.motion);
  if (!found) return std::nullopt;
  return Instability{found->landing ? motion.phi_f : motion.phi_i, found->rate};
}

CheckedLanding checked_landing(const Scene& scene, const Actuator& actuator, const Motion& motion,
                               const SimulateOptions& options, double rate) {
  const Landing l = simulate(scene, actuator.sea, motion, options, rate);
  return {scene,
          motion,
          options.accuracy,
          l,
          sensitivity(scene, actuator.sea, motion, options, l.peak),
          ratings(scene, actuator, motion, l),
          instability(scene, actuator.sea, motion)};
}

std::optional<Landing> held_landing(const CheckedLanding& c, const SeaParameters<double>& sea, double rate) {
  if (!moves(c.motion) && c.motion.phi_i == kHeld.phi_i) return std::nullopt;
  Landing held = simulate(c.scene, sea, kHeld, {.accuracy = c.accuracy}, rate);
  return no_landing(held.end) ? std::nullopt : std::optional(std::move(held));
}

}  // namespace ukemi::landing

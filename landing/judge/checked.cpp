#include "landing/judge/checked.hpp"

#include "common/drive_stability.hpp"
#include "landing/judge/under_scatter.hpp"

namespace ukemi::landing {

Ratings ratings(const Scene& scene, const Actuator& actuator, const Motion& motion, const Landing& landing) {
  return {peak_reference_rate(motion, landing.contacts.first() + scene.detection_delay), landing.demands,
          actuator.speed_max, actuator.motor_torque_max, actuator.sea.tau_max};
}

std::optional<Instability> instability(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion) {
  const TwoLinkDynamics<double> links(scene.robot);
  std::optional<Instability> worst;
  const SeaParameters<double> landing = with_landing_gains(sea, motion);
  for (const auto& [phi, drive] : {std::pair{motion.phi_i, &sea}, {motion.phi_f, &landing}})
    if (const double rate = growth_rate(*drive, joint_inertia(links, phi)); rate > (worst ? worst->rate : 0))
      worst = {phi, rate};
  return worst;
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

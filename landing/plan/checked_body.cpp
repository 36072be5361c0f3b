#include "landing/plan/checked_body.hpp"

#include <algorithm>
#include <cmath>

#include "landing/model/motion.hpp"

namespace ukemi::landing {

namespace {

/// Perturbs the numbers by 1e-6 relative.
void perturb(BodyScene& s, Random& random) {
  const auto vary = [&](double& x) { landing::perturb(x, random); };
  for (Link& l : s.robot.links) vary(l.mass), vary(l.inertia_com), vary(l.at.along), vary(l.com.along);
  for (ContactPoint& c : s.robot.contacts)
    for (double* x : {&c.law.stiffness, &c.law.damping_normal, &c.law.damping_tangential}) vary(*x);
  for (double* x : {&s.drop.height, &s.drop.forward_speed, &s.drop.pitch, &s.drop.pitch_rate, &s.robot.gravity})
    vary(*x);
}

}  // namespace

CheckedBody checked_body(const BodyScene& scene, const BodyMotion& motion, const SimulateOptions& options, double rate,
                         int draws) {
  CheckedBody out{scene, motion, simulate(scene, motion, options, rate), {}, options.accuracy};
  if (out.landing.end == End::kFailed) return out;
  const auto play = [&](double accuracy, Random* random) -> std::optional<double> {
    BodyScene s = scene;
    if (random) perturb(s, *random);
    SimulateOptions tighter = options;
    tighter.accuracy = accuracy;
    const BodyLanding l = simulate(s, motion, tighter);
    return l.end == End::kFailed ? std::nullopt : std::optional(l.peak);
  };
  out.sensitivity = sensitivity(out.landing.peak, options.accuracy, play, draws, 1);
  return out;
}

std::optional<BodyLanding> held_landing(const CheckedBody& c, double rate) {
  if (std::none_of(c.motion.begin(), c.motion.end(), [](const Motion& m) { return moves(m); })) return std::nullopt;
  BodyLanding held = simulate(c.scene, held_posture(c.scene), {.accuracy = c.accuracy}, rate);
  return no_landing(held.end) ? std::nullopt : std::optional(std::move(held));
}

}  // namespace ukemi::landing

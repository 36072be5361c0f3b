#include "landing/plan/checked_body.hpp"

#include <algorithm>

namespace ukemi::landing {

namespace {

/// Every number moved by 1e-6 relative.
void move_a_little(BodyScene& s, Random& random) {
  const auto move = [&](double& x) { landing::move_a_little(x, random); };
  for (Link& l : s.robot.links) move(l.mass), move(l.inertia_com), move(l.at.along), move(l.com.along);
  for (ContactPoint& c : s.robot.contacts)
    for (double* x : {&c.law.stiffness, &c.law.damping_normal, &c.law.damping_tangential}) move(*x);
  for (double* x : {&s.drop.height, &s.drop.forward_speed, &s.drop.pitch, &s.drop.pitch_rate, &s.robot.gravity})
    move(*x);
}

}  // namespace

CheckedBody checked_body(const BodyScene& scene, const BodyMotion& motion, const SimulateOptions& options, double rate,
                         int draws) {
  CheckedBody out{scene, motion, simulate(scene, motion, options, rate), {}, options.accuracy};
  if (out.landing.end == End::kFailed) return out;
  const auto play = [&](double accuracy, Random* random) -> std::optional<double> {
    BodyScene s = scene;
    if (random) move_a_little(s, *random);
    SimulateOptions tighter = options;
    tighter.accuracy = accuracy;
    const BodyLanding l = simulate(s, motion, tighter);
    return l.end == End::kFailed ? std::nullopt : std::optional(l.peak);
  };
  out.sensitivity = sensitivity(out.landing.peak, options.accuracy, play, draws, 1);
  return out;
}

std::optional<BodyLanding> held_beside(const CheckedBody& c, double rate) {
  if (std::none_of(c.motion.begin(), c.motion.end(), [](const Motion& m) { return moves(m); })) return std::nullopt;
  BodyLanding held = simulate(c.scene, held_posture(c.scene), {.accuracy = c.accuracy}, rate);
  return no_landing(held.end) ? std::nullopt : std::optional(std::move(held));
}

}  // namespace ukemi::landing

#include "landing/plan/checked_body.hpp"

#include <algorithm>
#include <cmath>

#include "common/random.hpp"

namespace ukemi::landing {

namespace {

/// Every number moved by 1e-6 relative.
BodyScene moved(BodyScene s, Random random) {
  constexpr double kMove = 1e-6;
  const auto move = [&](double& x) { x *= random.uniform() < 0.5 ? 1 - kMove : 1 + kMove; };
  for (Link& l : s.robot.links) move(l.mass), move(l.inertia_com), move(l.at.along), move(l.com.along);
  for (ContactPoint& c : s.robot.contacts)
    for (double* x : {&c.law.stiffness, &c.law.damping_normal, &c.law.damping_tangential}) move(*x);
  for (double* x : {&s.drop.height, &s.drop.forward_speed, &s.drop.pitch, &s.drop.pitch_rate, &s.robot.gravity})
    move(*x);
  return s;
}

}  // namespace

CheckedBody checked_body(const BodyScene& scene, const BodyMotion& motion, const SimulateOptions& options, double rate,
                         int draws) {
  CheckedBody out{scene, motion, simulate(scene, motion, options, rate), {}, options.accuracy};
  SimulateOptions tighter = options;
  tighter.accuracy = std::max(1e-13, options.accuracy / 100);
  const BodyLanding tight = simulate(scene, motion, tighter);
  if (tight.end == End::kFailed || out.landing.end == End::kFailed) return out;
  Sensitivity& s = out.sensitivity;
  const auto change = [](double a, double b) { return b > 0 ? std::abs(a - b) / b : 0; };
  s.checked = true;
  s.error_estimate = change(out.landing.peak, tight.peak);
  for (int i = 0; i < draws && s.change <= kCliff; ++i)
    if (const BodyLanding l = simulate(moved(scene, Random(1, std::uint64_t(i))), motion, tighter);
        l.end != End::kFailed)
      s.change = std::max(s.change, change(l.peak, tight.peak));
  s.sensitive = s.change > kCliff;
  s.right = s.sensitive || s.error_estimate <= kCliff;
  return out;
}

}  // namespace ukemi::landing

#include "landing/judge/sensitivity.hpp"

#include <algorithm>
#include <cmath>

#include "common/checks.hpp"
#include "common/random.hpp"

namespace ukemi::landing {

Sensitivity sensitivity(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                        const SimulateOptions& options, double peak, int draws, std::uint64_t seed) {
  check_count("draws", draws, 0, 1'000'000);
  constexpr double kMove = 1e-6;
  Sensitivity out;
  SimulateOptions tighter = options;
  tighter.accuracy = std::max(1e-13, options.accuracy / 100);
  const auto play = [&](const Scene& s) { return simulate(s, sea, motion, tighter); };
  const Landing tight = play(scene);
  if (tight.end == End::kFailed) return out;  // nothing to compare with
  out.checked = true;
  const auto change = [](double a, double b) { return b > 0 ? std::abs(a - b) / b : 0; };
  out.error_estimate = change(peak, tight.peak);
  for (int i = 0; i < draws && out.change <= kCliff; ++i) {
    Random random(seed, std::uint64_t(i));
    const auto move = [&](double& x) { x *= random.uniform() < 0.5 ? 1 - kMove : 1 + kMove; };
    Scene s = scene;
    for (double* x :
         {&s.robot.mass[0], &s.robot.mass[1], &s.robot.inertia_com[0], &s.robot.inertia_com[1], &s.robot.link_length,
          &s.robot.gravity, &s.drop.height, &s.drop.forward_speed, &s.drop.pitch, &s.drop.pitch_rate})
      move(*x);
    if (s.floor)
      for (double* x : {&s.floor->stiffness, &s.floor->damping_normal, &s.floor->damping_tangential}) move(*x);
    if (const Landing moved = play(s); moved.end != End::kFailed)
      out.change = std::max(out.change, change(moved.peak, tight.peak));
  }
  out.sensitive = out.change > kCliff;
  out.right = out.sensitive || out.error_estimate <= kCliff;
  return out;
}

}  // namespace ukemi::landing

#include "landing/judge/sensitivity.hpp"

#include <algorithm>
#include <cmath>

#include "common/checks.hpp"

namespace ukemi::landing {

void perturb(double& x, Random& random) {
  constexpr double kMove = 1e-6;
  x *= random.uniform() < 0.5 ? 1 - kMove : 1 + kMove;
}

Sensitivity sensitivity(double peak, double accuracy, const PerturbedPeak& play, int draws, std::uint64_t seed) {
  check_count("draws", draws, 0, 1'000'000);
  Sensitivity out;
  const double tighter = std::max(1e-13, accuracy / 100);
  const std::optional<double> tight = play(tighter, nullptr);
  if (!tight) return out;  // nothing to compare with
  out.checked = true;
  const auto relative_change = [](double a, double b) { return b > 0 ? std::abs(a - b) / b : 0; };
  out.error_estimate = relative_change(peak, *tight);
  for (int i = 0; i < draws && out.change <= kCliff; ++i) {
    Random random(seed, std::uint64_t(i));
    if (const auto other = play(tighter, &random)) out.change = std::max(out.change, relative_change(*other, *tight));
  }
  out.sensitive = out.change > kCliff;
  out.right = out.sensitive || out.error_estimate <= kCliff;
  return out;
}

Sensitivity sensitivity(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                        const SimulateOptions& options, double peak, int draws, std::uint64_t seed) {
  const auto play = [&](double accuracy, Random* random) -> std::optional<double> {
    Scene s = scene;
    if (random) {
      for (double* x :
           {&s.robot.mass[0], &s.robot.mass[1], &s.robot.inertia_com[0], &s.robot.inertia_com[1], &s.robot.link_length,
            &s.robot.gravity, &s.drop.height, &s.drop.forward_speed, &s.drop.pitch, &s.drop.pitch_rate})
        perturb(*x, *random);
      if (s.floor)
        for (double* x : {&s.floor->stiffness, &s.floor->damping_normal, &s.floor->damping_tangential})
          perturb(*x, *random);
    }
    SimulateOptions tighter = options;
    tighter.accuracy = accuracy;
    const Landing l = simulate(s, sea, motion, tighter);
    return l.end == End::kFailed ? std::nullopt : std::optional(l.peak);
  };
  return sensitivity(peak, options.accuracy, play, draws, seed);
}

}  // namespace ukemi::landing

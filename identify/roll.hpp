// One trial from stretch to stretch: the loop that every method and every kernel shares. Included by the files that
// compile kernels (rollout.cpp, rollout_methods.cpp), by no other.
#pragma once

#include <cmath>

#include "identify/rollout.hpp"

namespace ukemi::identify {

/// One trial with `Method` and the kernel of `kTerms`, see `rollout`.
template <class Method, SeaTerms kTerms, class T>
RolloutStatus roll(const Rig& rig, const SeaParameters<T>& sea, const InitialState<T>& initial,
                   const PreparedTrial& trial, const RolloutOptions& options, std::vector<T>& phi,
                   std::vector<T>& phi_m) {
  using System = OneLinkSystem<kTerms, T>;
  System system(sea, rig.length, rig.inertia);
  const std::vector<double>& t = trial.trial->t;
  phi.resize(t.size()), phi_m.resize(t.size());
  typename System::State y;
  y << T(trial.phi_start) + initial.angle, T(trial.phi_start) + initial.angle, initial.rate, T(0);
  phi[0] = y[System::kPhi], phi_m[0] = y[System::kPhiM];
  if (trial.stretches.empty()) return RolloutStatus::kDone;
  system.input = trial.stretches.front().input;
  integrate::Integrator<Method, System> integrator(
      system, t[0], y,
      {.accuracy = options.accuracy, .first_step = std::min(1e-3, options.max_step), .max_step = options.max_step});
  long steps = 0;
  double paced = t[0];
  for (const PreparedTrial::Stretch& stretch : trial.stretches) {
    system.input = stretch.input;
    if (stretch.jumps) integrator.refresh();
    std::size_t sample = stretch.first + 1;
    for (;;) {
      const integrate::Outcome outcome = integrator.step(stretch.t_end);
      if (outcome.status > integrate::Status::kEvent || ++steps > options.max_steps) return RolloutStatus::kDiverged;
      const double end = integrator.time();
      // Constants too stiff for an explicit method show early: at the pace of the last steps the rest would take too
      // many.
      constexpr long kPace = 200;
      if (steps % kPace == 0) {
        if (double(kPace) * (t.back() - end) > double(options.max_steps) * (end - paced))
          return RolloutStatus::kDiverged;
        paced = end;
      }
      const bool reached = outcome.status == integrate::Status::kReached;
      while (sample <= stretch.last && (t[sample] < end || reached)) {
        if (sample == stretch.last && reached) {
          phi[sample] = integrator.state()[System::kPhi], phi_m[sample] = integrator.state()[System::kPhiM];
        } else {
          const auto& step = integrator.dense();
          const double s = (t[sample] - step.t) / step.h;
          phi[sample] = step.component_at(System::kPhi, s), phi_m[sample] = step.component_at(System::kPhiM, s);
        }
        ++sample;
      }
      const double angle = value_of(integrator.state()[System::kPhi]);
      if (!(std::abs(angle - trial.phi_start) < options.escape))
        return std::isfinite(angle) ? RolloutStatus::kEscaped : RolloutStatus::kDiverged;
      if (outcome.event >= 0) {
        system.cross(outcome.event);
        integrator.refresh();
      }
      if (reached) break;
    }
  }
  if (options.work) *options.work = integrator.counters();
  return RolloutStatus::kDone;
}

}  // namespace ukemi::identify

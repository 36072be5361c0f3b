#include "identify/rollout.hpp"

#include <cmath>

namespace ukemi::identify {

const char* name(RolloutStatus status) {
  switch (status) {
    case RolloutStatus::kDone:
      return "done";
    case RolloutStatus::kEscaped:
      return "the link escapes";
    case RolloutStatus::kDiverged:
      return "the motion diverges";
  }
  return "?";
}

PreparedTrial::PreparedTrial(const Trial& source) : trial(&source) {
  const std::vector<double>&t = source.t, &f = source.force, &r = source.phi_ref, &d = source.dphi_ref;
  phi_start = r.empty() ? 0 : r[0];
  for (std::size_t i = 0; i + 1 < t.size(); ++i) {
    const double dt = t[i + 1] - t[i];
    Excitation e{.t = t[i]};
    if (!f.empty()) e.force = f[i], e.force_rate = (f[i + 1] - f[i]) / dt;
    if (!r.empty()) e.phi_ref = r[i];
    if (!d.empty()) {
      e.phi_ref_rate = (r[i + 1] - r[i]) / dt;
      e.dphi_ref = d[i], e.dphi_ref_rate = (d[i + 1] - d[i]) / dt;
    }
    const bool constant = e.force_rate == 0 && e.phi_ref_rate == 0 && e.dphi_ref_rate == 0;
    if (!stretches.empty() && constant) {
      Stretch& last = stretches.back();
      const Excitation& p = last.input;
      if (p.force_rate == 0 && p.phi_ref_rate == 0 && p.dphi_ref_rate == 0 && p.force == e.force &&
          p.phi_ref == e.phi_ref && p.dphi_ref == e.dphi_ref) {
        last.t_end = t[i + 1], last.last = i + 1;
        continue;
      }
    }
    const bool jumps = i > 0 && !r.empty() && d.empty() && r[i] != r[i - 1];
    stretches.push_back({e, t[i + 1], i, i + 1, jumps});
  }
}

namespace {

template <SeaTerms kTerms, class T>
RolloutStatus run(const Rig& rig, const SeaParameters<T>& sea, const InitialState<T>& initial,
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
  integrate::Integrator<integrate::DormandPrince853, System> integrator(
      system, t[0], y, {.accuracy = options.accuracy, .first_step = 1e-3, .max_step = 0.05});
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
  return RolloutStatus::kDone;
}

}  // namespace

template <class T>
RolloutStatus rollout(const Rig& rig, const SeaParameters<T>& sea, const InitialState<T>& initial,
                      const PreparedTrial& trial, const RolloutOptions& options, std::vector<T>& phi,
                      std::vector<T>& phi_m) {
  // Value and derivative both count: a constant at 0 that is being fitted needs its term.
  const auto present = [](const T& x) {
    if constexpr (std::is_same_v<T, double>)
      return x != 0;
    else
      return x.a != 0 || !x.v.isZero(0);
  };
  const bool limited = std::isfinite(value_of(sea.tau_max));
  const bool extended = present(sea.friction) || present(sea.k_sea_cubic) || sea.feedback == Feedback::kMotor;
  const auto with = [&]<SeaTerms kTerms>() { return run<kTerms>(rig, sea, initial, trial, options, phi, phi_m); };
  if (extended)
    return limited ? with.template operator()<SeaTerms{true, true}>()
                   : with.template operator()<SeaTerms{false, true}>();
  return limited ? with.template operator()<SeaTerms{true, false}>()
                 : with.template operator()<SeaTerms{false, false}>();
}

template RolloutStatus rollout(const Rig&, const SeaParameters<double>&, const InitialState<double>&,
                               const PreparedTrial&, const RolloutOptions&, std::vector<double>&, std::vector<double>&);
using Small = ceres::Jet<double, kSmallJet>;
using Large = ceres::Jet<double, kLargeJet>;
template RolloutStatus rollout(const Rig&, const SeaParameters<Small>&, const InitialState<Small>&,
                               const PreparedTrial&, const RolloutOptions&, std::vector<Small>&, std::vector<Small>&);
template RolloutStatus rollout(const Rig&, const SeaParameters<Large>&, const InitialState<Large>&,
                               const PreparedTrial&, const RolloutOptions&, std::vector<Large>&, std::vector<Large>&);

}  // namespace ukemi::identify

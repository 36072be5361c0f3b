#include "identify/rollout.hpp"

#include <algorithm>
#include <cmath>

#include "identify/roll.hpp"

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
  const std::vector<double> f = force_at_samples(source);
  const std::vector<double>&t = source.t, &r = source.phi_ref, &d = source.dphi_ref;
  phi_start = r.empty() ? 0 : r[0];
  std::vector<double> intervals;
  for (std::size_t i = 0; i + 1 < t.size(); ++i) intervals.push_back(t[i + 1] - t[i]);
  const auto middle = intervals.begin() + long(intervals.size() / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  spacing = intervals.empty() ? 0 : *middle;
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
  if constexpr (kDerivatives<T> <= kSmallJet)
    if (options.method) return roll_with_method(rig, sea, initial, trial, options, phi, phi_m);
  const auto with = [&]<SeaTerms kTerms>() {
    // A kernel without friction and stiffening integrates hits alone, from sample to sample: no place for long steps.
    using Explicit = std::conditional_t<kTerms.extended, integrate::DormandPrince853, integrate::DormandPrince54>;
    return Roll<Explicit, kTerms, T>(rig, sea, initial, trial, options, phi, phi_m).run();
  };
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

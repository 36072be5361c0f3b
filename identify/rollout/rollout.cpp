#include "identify/rollout/rollout.hpp"

#include <algorithm>
#include <cmath>

#include "common/checks.hpp"
#include "common/force_curve.hpp"
#include "common/median.hpp"
#include "identify/logs/hits.hpp"
#include "identify/rollout/kernels.hpp"

namespace ukemi::identify {

const char* name(RolloutStatus status) {
  constexpr const char* kNames[] = {"done", "the link escapes", "the motion diverges"};
  return kNames[int(status)];
}

void RolloutOptions::validate() const {
  check_positive("accuracy", accuracy), check_positive("max_step", max_step);
  if (escape != std::numeric_limits<double>::infinity()) check_positive("escape", escape);
  check_count("max_steps", max_steps, 1, 1'000'000'000);
}

PreparedTrial::PreparedTrial(const Trial& source) : trial((source.validate(), &source)), segments(cut(0)) {
  const std::vector<double>& t = source.t;
  phi_start = source.phi_ref.empty() ? 0 : source.phi_ref[0];
  std::vector<double> intervals;
  for (std::size_t i = 0; i + 1 < t.size(); ++i) intervals.push_back(t[i + 1] - t[i]);
  spacing = intervals.empty() ? 0 : median(std::move(intervals));
}

std::vector<PreparedTrial::Segment> PreparedTrial::cut(double shift, double delay) const {
  const std::vector<double>&t = trial->t, &r = trial->phi_ref, &d = trial->dphi_ref, &c = trial->command;
  const ForceCurve force({.t = trial->force_t.empty() ? t : trial->force_t,
                          .force = trial->force,
                          .rest = trial->force_rest,
                          .smooth = trial->force_smooth == 0 ? std::nullopt : std::optional(trial->force_smooth),
                          .within = kHitEnd * trial->force_noise});
  const std::size_t begins = trial->force.empty() ? 0 : force.pieces() + 1;
  std::vector<Segment> out;
  constexpr double kSameTime = 1e-12;  // tolerance of equal times [s]
  double force_end = 0, previous_command = c.empty() ? 0 : c.front();
  std::size_t begun = 0;           // number of the force's pieces that have begun
  std::size_t command_sample = 0;  // the sample whose command the motor follows
  for (std::size_t i = 0; i + 1 < t.size(); ++i) {
    for (double from = t[i]; from < t[i + 1];) {
      while (begun < begins && force.begin(begun) + shift <= from + kSameTime) ++begun;
      double to = begun < begins ? std::min(t[i + 1], force.begin(begun) + shift) : t[i + 1];
      if (!c.empty()) {
        const auto begins_at = [&](std::size_t k) { return t[k] + delay; };
        while (command_sample + 1 < c.size() && begins_at(command_sample + 1) <= from + kSameTime) ++command_sample;
        if (command_sample + 1 < c.size()) to = std::min(to, begins_at(command_sample + 1));
      }
      if (t[i + 1] - to < kSameTime) to = t[i + 1];
      Excitation<double> e{.t = from};
      if (begun > 0 && begun < begins) e.force = shifted(force.piece(begun - 1), from - shift - force.begin(begun - 1));
      e.has_force = e.force != Cubic{}, e.curved = e.force[2] != 0 || e.force[3] != 0;
      if (!r.empty()) e.phi_ref = r[i];
      if (!c.empty()) e.command = c[command_sample];
      if (!d.empty()) {
        const double dt = t[i + 1] - t[i];
        e.dphi_ref_rate = (d[i + 1] - d[i]) / dt, e.dphi_ref = d[i] + e.dphi_ref_rate * (from - t[i]);
        e.phi_ref_rate = (r[i + 1] - r[i]) / dt, e.phi_ref += e.phi_ref_rate * (from - t[i]);
      }
      const bool reference_jumps = i > 0 && from == t[i] && !r.empty() && d.empty() && r[i] != r[i - 1];
      const bool command_jumps = e.command != previous_command;
      previous_command = e.command;
      const bool jumps =
          reference_jumps || command_jumps || std::abs(e.force[0] - force_end) > 1e-9 * (1 + std::abs(force_end));
      const auto constant = [](const Excitation<double>& x) {
        return !x.has_force && x.phi_ref_rate == 0 && x.dphi_ref == 0 && x.dphi_ref_rate == 0;
      };
      if (!out.empty() && !jumps && constant(e) && constant(out.back().input))
        out.back().t_end = to;
      else
        out.push_back({e, to, jumps});
      force_end = e.force_at(to - from);
      from = to;
    }
  }
  return out;
}

template RolloutStatus rollout(const Rig&, const SeaParameters<double>&, const Nuisance<double>&, const PreparedTrial&,
                               const RolloutOptions&, std::vector<double>&, std::vector<double>&, std::vector<double>*);

}  // namespace ukemi::identify

#include "identify/rollout/rollout.hpp"

#include <algorithm>
#include <cmath>

#include "common/checks.hpp"
#include "common/force_curve.hpp"
#include "common/median.hpp"
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

PreparedTrial::PreparedTrial(const Trial& source) : trial((source.validate(), &source)), stretches(cut(0)) {
  const std::vector<double>& t = source.t;
  phi_start = source.phi_ref.empty() ? 0 : source.phi_ref[0];
  std::vector<double> intervals;
  for (std::size_t i = 0; i + 1 < t.size(); ++i) intervals.push_back(t[i + 1] - t[i]);
  spacing = intervals.empty() ? 0 : median(std::move(intervals));
}

std::vector<PreparedTrial::Stretch> PreparedTrial::cut(double shift, double delay) const {
  const std::vector<double>&t = trial->t, &r = trial->phi_ref, &d = trial->dphi_ref, &c = trial->command;
  const ForceCurve force({.t = trial->force_t.empty() ? t : trial->force_t,
                          .force = trial->force,
                          .rest = trial->force_rest,
                          .smooth = trial->force_smooth == 0 ? std::nullopt : std::optional(trial->force_smooth)});
  const std::size_t begins = trial->force.empty() ? 0 : force.pieces() + 1;
  std::vector<Stretch> out;
  constexpr double kNow = 1e-12;  // times that differ by rounding are one [s]
  double force_end = 0, command_before = c.empty() ? 0 : c.front();
  std::size_t j = 0;        // so many of the force's pieces have begun
  std::size_t command = 0;  // the sample whose command the motor follows
  for (std::size_t i = 0; i + 1 < t.size(); ++i) {
    for (double from = t[i]; from < t[i + 1];) {
      while (j < begins && force.begin(j) + shift <= from + kNow) ++j;
      double to = j < begins ? std::min(t[i + 1], force.begin(j) + shift) : t[i + 1];
      if (!c.empty()) {
        const auto begins_at = [&](std::size_t k) { return t[k] + delay; };
        while (command + 1 < c.size() && begins_at(command + 1) <= from + kNow) ++command;
        if (command + 1 < c.size()) to = std::min(to, begins_at(command + 1));
      }
      if (t[i + 1] - to < kNow) to = t[i + 1];
      Excitation<double> e{.t = from};
      if (j > 0 && j < begins) e.force = moved(force.piece(j - 1), from - shift - force.begin(j - 1));
      e.pushed = e.force != Cubic{}, e.curved = e.force[2] != 0 || e.force[3] != 0;
      if (!r.empty()) e.phi_ref = r[i];
      if (!c.empty()) e.command = c[command];
      if (!d.empty()) {
        const double dt = t[i + 1] - t[i];
        e.dphi_ref_rate = (d[i + 1] - d[i]) / dt, e.dphi_ref = d[i] + e.dphi_ref_rate * (from - t[i]);
        e.phi_ref_rate = (r[i + 1] - r[i]) / dt, e.phi_ref += e.phi_ref_rate * (from - t[i]);
      }
      const bool reference_jumps = i > 0 && from == t[i] && !r.empty() && d.empty() && r[i] != r[i - 1];
      const bool command_jumps = e.command != command_before;
      command_before = e.command;
      const bool jumps =
          reference_jumps || command_jumps || std::abs(e.force[0] - force_end) > 1e-9 * (1 + std::abs(force_end));
      const auto still = [](const Excitation<double>& x) {
        return !x.pushed && x.phi_ref_rate == 0 && x.dphi_ref == 0 && x.dphi_ref_rate == 0;
      };
      if (!out.empty() && !jumps && still(e) && still(out.back().input))
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

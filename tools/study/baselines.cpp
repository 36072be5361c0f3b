#include "tools/study/baselines.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace ukemi::tools {

namespace {

using landing::DropLog;

/// A channel of a log at t, linearly interpolated; absent outside the log and next to an empty cell.
std::optional<double> value_at(const DropLog& log, std::size_t channel, double t) {
  const std::vector<double>& x = log.output[channel];
  if (x.empty() || t < log.t.front() || t > log.t.back()) return std::nullopt;
  const std::size_t next = std::size_t(std::upper_bound(log.t.begin(), log.t.end() - 1, t) - log.t.begin());
  const double fraction = (t - log.t[next - 1]) / (log.t[next] - log.t[next - 1]);
  const double out = std::lerp(x[next - 1], x[next], fraction);
  return std::isfinite(out) ? std::optional(out) : std::nullopt;
}

/// The mean of the other logs at t; absent where fewer than two of them have a value.
std::optional<double> mean_of_others(const std::vector<const DropLog*>& logs, std::size_t m, std::size_t channel,
                                     double t) {
  double sum = 0;
  int n = 0;
  for (std::size_t k = 0; k < logs.size(); ++k)
    if (const auto x = k == m ? std::nullopt : value_at(*logs[k], channel, t)) sum += *x, ++n;
  return n >= 2 ? std::optional(sum / n) : std::nullopt;
}

Baseline baseline_of(const FloorFit& played, const std::vector<const DropLog*>& logs, std::size_t channel) {
  const bool enough = logs.size() >= 3;
  double model = 0, held = 0, mean = 0;
  long n = 0;
  for (std::size_t m = 0; m < logs.size(); ++m) {
    const std::vector<double>&measured = logs[m]->output[channel], &simulated = played.drops[m].value[channel];
    const auto first = std::find_if(measured.begin(), measured.end(), [](double x) { return std::isfinite(x); });
    for (std::size_t i = 0; i < std::min(measured.size(), simulated.size()); ++i) {
      if (!std::isfinite(measured[i]) || !std::isfinite(simulated[i])) continue;
      const auto others = enough ? mean_of_others(logs, m, channel, logs[m]->t[i]) : std::nullopt;
      if (enough && !others) continue;
      const auto squared = [&](double x) { return (x - measured[i]) * (x - measured[i]); };
      model += squared(simulated[i]), held += squared(*first), mean += enough ? squared(*others) : 0, ++n;
    }
  }
  Baseline out;
  if (n == 0) return out;
  out.model = std::sqrt(model / double(n)), out.held = std::sqrt(held / double(n));
  if (enough) out.mean = std::sqrt(mean / double(n));
  return out;
}

}  // namespace

std::vector<Baseline> baselines(const FloorFit& played, const std::vector<const DropLog*>& logs) {
  std::vector<Baseline> out;
  for (std::size_t c = 0; c < played.channels.size(); ++c)
    out.push_back(std::all_of(played.drops.begin(), played.drops.end(), [](auto& d) { return d.simulated; })
                      ? baseline_of(played, logs, c)
                      : Baseline{});
  return out;
}

}  // namespace ukemi::tools

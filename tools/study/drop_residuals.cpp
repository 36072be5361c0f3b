#include "tools/study/drop_residuals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "common/median.hpp"
#include "identify/logs/trial.hpp"
#include "identify/logs/trial_checks.hpp"
#include "landing/model/release.hpp"

namespace ukemi::tools {

using namespace landing;
using identify::ResidualBlock;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr long kMostSteps = 20'000;  ///< of one drop: ten times what any of datasets/drops takes

}  // namespace

DropResiduals::DropResiduals(const Scene& scene, const SeaParameters<double>& sea, const LoggedDrop& drop,
                             const DropLayout& layout, const CalibrationOptions& options, long& steps)
    : scene_(scene),
      sea_(sea),
      drop_(drop),
      layout_(layout),
      monitor_(options.monitor),
      steps_(steps),
      options_{.accuracy = options.accuracy, .max_steps = kMostSteps} {
  const std::vector<double>& t = drop.log.t;
  bool shifted = false;
  for (const auto* list : {&layout.shared, &layout.own})
    for (const DropTerm* term : *list) shifted = shifted || term->shifts_log();
  if (shifted) first_ = std::size_t(std::lower_bound(t.begin(), t.end(), kLargestShift) - t.begin());
  for (int o = 0; o < kOutputs; ++o) {
    std::vector<double> gaps;
    double last = kNaN;
    for (std::size_t i = 0; i < drop.log.output[std::size_t(o)].size(); ++i)
      if (std::isfinite(drop.log.output[std::size_t(o)][i])) {
        if (std::isfinite(last)) gaps.push_back(t[i] - last);
        last = t[i];
      }
    if (!gaps.empty()) interval_[std::size_t(o)] = median(gaps);
  }
}

ResidualBlock DropResiduals::block(const PerOutput& sigma, double seconds, const std::vector<Prior>& priors) const {
  const std::vector<double>& t = drop_.log.t;
  const auto end = std::size_t(std::upper_bound(t.begin(), t.end(), seconds) - t.begin());
  struct Row {
    int output;
    std::size_t sample;
  };
  std::vector<Row> rows;
  for (int o = 0; o < kOutputs; ++o)
    for (std::size_t i = first_; i < std::min(end, drop_.log.output[std::size_t(o)].size()); ++i)
      if (std::isfinite(drop_.log.output[std::size_t(o)][i])) rows.push_back({o, i});
  const auto memory = std::make_shared<Memory>();
  return {
      int(rows.size() + priors.size()),
      [=, this](const double* shared, const double* own, double* r, double* jacobian) {
        const Rolled* rolled = recall(*memory, shared, own, end);
        if (!rolled) return false;
        const std::size_t size = rows.size() + priors.size();
        std::size_t row = 0;
        const auto fill = [&](double residual, const auto& of_term) {
          double* to = jacobian ? jacobian + row : nullptr;
          for (const auto* list : {&layout_.shared, &layout_.own})
            for (const DropTerm* term : *list)
              if (to) *to = of_term(*term), to += size;
          r[row++] = residual;
        };
        for (const Row& x : rows) {
          const DropSample& s = rolled->rollout.samples[x.sample - first_];
          const double inverse = 1 / sigma[std::size_t(x.output)],
                       difference = s.value[std::size_t(x.output)] - drop_.log.output[std::size_t(x.output)][x.sample];
          if (left_out(*rolled, DropOutput(x.output), x.sample)) {
            fill(0, [](const DropTerm&) { return 0.0; });
            continue;
          }
          fill(difference * inverse, [&](const DropTerm& term) {
            const auto o = std::size_t(x.output);
            return inverse * (term.shifts_log() ? s.rate[o] : s.slope[o][drop_slot(term.derivative)]);
          });
        }
        for (const Prior& p : priors) {
          double value = 0;
          layout_.for_each(shared, own, [&](const DropTerm& term, double x, std::size_t) {
            if (term.name == p.term) value = x;
          });
          fill((value - p.value) / p.std, [&](const DropTerm& term) { return term.name == p.term ? 1 / p.std : 0; });
        }
        return true;
      }};
}

DropResult DropResiduals::replay(const double* shared, const double* own) const {
  DropResult out{.file = drop_.log.file};
  Rolled rolled;
  out.simulated = roll(shared, own, drop_.log.t.size(), options_, rolled);
  out.rms.fill(kNaN);
  out.peak_measured = out.peak_simulated = out.peak_between = kNaN;
  if (!out.simulated) return out;
  for (int o = 0; o < kOutputs; ++o) {
    const auto k = std::size_t(o);
    const std::vector<double>& measured = drop_.log.output[k];
    if (measured.empty()) continue;
    out.value[k].assign(measured.size(), kNaN), out.used[k].assign(measured.size(), false);
    double sum = 0;
    long n = 0;
    for (std::size_t i = first_; i < measured.size(); ++i) {
      if (!std::isfinite(measured[i])) continue;
      out.value[k][i] = rolled.rollout.samples[i - first_].value[k];
      if (left_out(rolled, DropOutput(o), i)) continue;
      out.used[k][i] = true;
      sum += std::pow(out.value[k][i] - measured[i], 2), ++n;
    }
    if (n > 0) out.rms[k] = std::sqrt(sum / double(n));
  }
  for (const double t : rolled.rollout.jumps) out.jumps.push_back(t - rolled.shift);
  SimulateOptions to_the_end = options_;
  to_the_end.rest = SimulateOptions::Rest::kIgnore;
  Scene scene = rolled.scene;
  scene.t_end = drop_.log.t.back() + rolled.shift;
  out.peak_between = peak_acceleration(scene, sea_, drop_.motion, to_the_end).peak;
  for (std::size_t i = first_; i < drop_.log.t.size(); ++i) {
    const auto& a = drop_.log.output;
    const double measured = !a[kAcc].empty()                         ? a[kAcc][i]
                            : !a[kAccX].empty() && !a[kAccY].empty() ? std::hypot(a[kAccX][i], a[kAccY][i])
                                                                     : kNaN;
    if (!std::isfinite(measured)) continue;
    out.peak_measured = std::fmax(out.peak_measured, measured);
    out.peak_simulated = std::fmax(out.peak_simulated, rolled.rollout.samples[i - first_].value[kAcc]);
  }
  return out;
}

const DropResiduals::Rolled* DropResiduals::recall(Memory& m, const double* shared, const double* own,
                                                   std::size_t end) const {
  std::vector<double> point(shared, shared + layout_.shared.size());
  point.insert(point.end(), own, own + layout_.own.size());
  if (monitor_.stopped()) return nullptr;
  if (point != m.point || m.point.empty()) {
    m.point = point;
    SimulateOptions options = options_;
    if (monitor_.stop) options.over = &monitor_.stop;
    m.complete = roll(shared, own, end, options, m.rolled);
  }
  return m.complete ? &m.rolled : nullptr;
}

bool DropResiduals::roll(const double* shared, const double* own, std::size_t end, const SimulateOptions& options,
                         Rolled& out) const {
  Scene& scene = out.scene = scene_;
  scene.drop = drop_.thrown;
  scene.drop.pitch = scene_.drop.pitch;
  out.shift = 0;
  layout_.for_each(shared, own, [&](const DropTerm& term, double value, std::size_t) {
    term.set_in(scene, value);
    if (term.shifts_log()) out.shift = value;
  });
  if (!(scene.drop.height >= 0 && scene.floor->stiffness > 0)) return false;
  std::vector<double> times;
  for (std::size_t i = first_; i < end; ++i) times.push_back(std::max(0.0, drop_.log.t[i] + out.shift));
  out.rollout = roll_drop(scene, sea_, drop_.motion, times, options);
  steps_ += out.rollout.steps;
  return out.rollout.complete;
}

bool DropResiduals::left_out(const Rolled& rolled, DropOutput o, std::size_t i) const {
  if (!landing::jumps(o)) return false;
  const std::vector<double>& jumps = rolled.rollout.jumps;
  const double width = interval_[std::size_t(o)], t = drop_.log.t[i] + rolled.shift;
  const auto next = std::lower_bound(jumps.begin(), jumps.end(), t - width);
  return next != jumps.end() && *next <= t + width;
}

PerOutput noise_of(const std::vector<LoggedDrop>& drops) {
  PerOutput out;
  for (std::size_t o = 0; o < kOutputs; ++o) {
    double sum = 0, n = 0, largest = 0;
    for (const LoggedDrop& d : drops) {
      std::vector<double> x;
      for (const double v : d.log.output[o])
        if (std::isfinite(v)) x.push_back(v), largest = std::max(largest, std::abs(v));
      sum += double(x.size()) * std::pow(identify::noise_level(x), 2), n += double(x.size());
    }
    constexpr double kFinest = 1e-9;  // of the output: a log without noise still has a weight
    out[o] = n > 0 ? std::max({std::sqrt(sum / n), kFinest * largest, 1e-12}) : kNaN;
  }
  return out;
}

PerOutput rms_of(const std::vector<DropResult>& drops) {
  PerOutput out;
  for (std::size_t o = 0; o < kOutputs; ++o) {
    double sum = 0, n = 0;
    for (const DropResult& d : drops)
      for (const bool used : d.used[o])
        if (used) n += 1, sum += d.rms[o] * d.rms[o];
    out[o] = n > 0 ? std::sqrt(sum / n) : kNaN;
  }
  return out;
}

}  // namespace ukemi::tools

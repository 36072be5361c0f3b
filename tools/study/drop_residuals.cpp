#include "tools/study/drop_residuals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "common/median.hpp"
#include "identify/logs/trial.hpp"
#include "identify/logs/trial_checks.hpp"

namespace ukemi::tools {

using namespace landing;
using identify::ResidualBlock;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr long kMaxSteps = 20'000;  ///< for one drop: ten times what any of datasets/drops takes

}  // namespace

DropResiduals::DropResiduals(const DropSimulator& simulator, std::size_t drop, const DropLayout& layout,
                             const CalibrationOptions& options, long& steps)
    : simulator_(simulator),
      drop_(drop),
      layout_(layout),
      monitor_(options.monitor),
      steps_(steps),
      options_{.accuracy = options.accuracy, .max_steps = kMaxSteps},
      interval_(log().output.size(), 0.0) {
  const std::vector<double>& t = log().t;
  bool shifted = false;
  for (const auto* list : {&layout.shared, &layout.own})
    for (const DropTerm* term : *list) shifted = shifted || term->shifts_log();
  if (shifted) first_ = std::size_t(std::lower_bound(t.begin(), t.end(), kLargestShift) - t.begin());
  for (std::size_t o = 0; o < log().output.size(); ++o) {
    std::vector<double> gaps;
    double last = kNaN;
    for (std::size_t i = 0; i < log().output[o].size(); ++i)
      if (std::isfinite(log().output[o][i])) {
        if (std::isfinite(last)) gaps.push_back(t[i] - last);
        last = t[i];
      }
    if (!gaps.empty()) interval_[o] = median(gaps);
  }
}

ResidualBlock DropResiduals::block(const std::vector<double>& sigma, double seconds,
                                   const std::vector<Prior>& priors) const {
  const std::vector<double>& t = log().t;
  const auto end = std::size_t(std::upper_bound(t.begin(), t.end(), seconds) - t.begin());
  struct Row {
    std::size_t output, sample;
  };
  std::vector<Row> rows;
  for (std::size_t o = 0; o < log().output.size(); ++o)
    for (std::size_t i = first_; i < std::min(end, log().output[o].size()); ++i)
      if (std::isfinite(log().output[o][i])) rows.push_back({o, i});
  const auto cache = std::make_shared<Cache>();
  return {int(rows.size() + priors.size()),
          [=, this](const double* shared, const double* own, double* r, double* jacobian) {
            const Rollout* rollout = rollout_at(*cache, shared, own, end, jacobian != nullptr);
            if (!rollout) return false;
            const std::size_t size = rows.size() + priors.size();
            std::size_t row = 0;
            // Sets a residual and, if needed, its derivatives by each term.
            const auto fill = [&](double residual, const auto& by_column) {
              if (jacobian)
                for (std::size_t c = 0; c < rollout->settings.size(); ++c) jacobian[c * size + row] = by_column(c);
              r[row++] = residual;
            };
            for (const Row& x : rows) {
              if (left_out(*rollout, x.output, x.sample)) {
                fill(0, [](std::size_t) { return 0.0; });
                continue;
              }
              const std::size_t n = x.sample - first_;
              const double inverse = 1 / sigma[x.output];
              fill((rollout->drop.value[x.output][n] - log().output[x.output][x.sample]) * inverse,
                   [&](std::size_t c) { return inverse * rollout->drop.slope[x.output](long(n), long(c)); });
            }
            for (const Prior& p : priors) {
              double value = 0;
              for (const Setting& x : rollout->settings)
                if (x.term->name == p.term) value = x.value;
              fill((value - p.value) / p.std,
                   [&](std::size_t c) { return rollout->settings[c].term->name == p.term ? 1 / p.std : 0; });
            }
            return true;
          }};
}

DropResult DropResiduals::replay(const double* shared, const double* own, Peaks peaks) const {
  const std::size_t outputs = log().output.size();
  DropResult out{.file = log().file};
  out.value.resize(outputs), out.used.resize(outputs), out.rms.assign(outputs, kNaN);
  Rollout rollout;
  roll(shared, own, log().t.size(), options_, rollout);
  out.simulated = rollout.drop.complete;
  out.peak_measured = out.peak_simulated = out.peak_between = kNaN;
  if (!out.simulated) return out;
  for (std::size_t k = 0; k < outputs; ++k) {
    const std::vector<double>& measured = log().output[k];
    if (measured.empty()) continue;
    out.value[k].assign(measured.size(), kNaN), out.used[k].assign(measured.size(), false);
    double sum = 0;
    long n = 0;
    for (std::size_t i = first_; i < measured.size(); ++i) {
      if (!std::isfinite(measured[i])) continue;
      out.value[k][i] = rollout.drop.value[k][i - first_];
      if (left_out(rollout, k, i)) continue;
      out.used[k][i] = true;
      sum += std::pow(out.value[k][i] - measured[i], 2), ++n;
    }
    if (n > 0) out.rms[k] = std::sqrt(sum / double(n));
  }
  for (const double t : rollout.drop.jumps) out.jumps.push_back(t - rollout.shift);
  out.changes = rollout.drop.changes;
  if (peaks == Peaks::kSkip) return out;
  out.peak_between = simulator_.peak(drop_, rollout.settings, log().t.back() + rollout.shift, options_);
  if (std::isnan(out.peak_between) || simulator_.logs_of() == LogsOf::kTrials) return out;
  for (std::size_t i = first_; i < log().t.size(); ++i) {
    const auto& a = log().output;
    const double measured = !a[kAcc].empty()                         ? a[kAcc][i]
                            : !a[kAccX].empty() && !a[kAccY].empty() ? std::hypot(a[kAccX][i], a[kAccY][i])
                                                                     : kNaN;
    if (!std::isfinite(measured)) continue;
    out.peak_measured = std::fmax(out.peak_measured, measured);
    out.peak_simulated = std::fmax(out.peak_simulated, rollout.drop.value[kAcc][i - first_]);
  }
  return out;
}

const DropResiduals::Rollout* DropResiduals::rollout_at(Cache& cache, const double* shared, const double* own,
                                                        std::size_t end, bool slopes) const {
  std::vector<double> point(shared, shared + layout_.shared.size());
  point.insert(point.end(), own, own + layout_.own.size());
  if (monitor_.stopped()) return nullptr;
  SimulateOptions options = options_;
  if (monitor_.stop) options.over = &monitor_.stop;
  if (point != cache.point || cache.point.empty()) {
    cache.point = point;
    roll(shared, own, end, options, cache.rollout);
  }
  FollowedDrop& drop = cache.rollout.drop;
  if (!drop.complete) return nullptr;
  if (slopes && drop.slope.empty()) {
    const long before = drop.steps;
    if (!simulator_.differentiate(drop_, cache.rollout.settings, cache.rollout.times, options, drop)) return nullptr;
    steps_ += drop.steps - before;
  }
  return &cache.rollout;
}

void DropResiduals::roll(const double* shared, const double* own, std::size_t end, const SimulateOptions& options,
                         Rollout& out) const {
  out.settings.clear(), out.times.clear();
  out.shift = 0;
  layout_.for_each(shared, own, [&](const DropTerm& term, double value, std::size_t) {
    out.settings.push_back({&term, value});
    if (term.shifts_log()) out.shift = value;
  });
  for (std::size_t i = first_; i < end; ++i) out.times.push_back(std::max(0.0, log().t[i] + out.shift));
  out.drop = simulator_.follow(drop_, out.settings, out.times, options);
  steps_ += out.drop.steps;
}

bool DropResiduals::left_out(const Rollout& rollout, std::size_t channel, std::size_t i) const {
  if (!simulator_.channels()[channel].jumps) return false;
  const std::vector<double>& jumps = rollout.drop.jumps;
  const double width = interval_[channel], t = log().t[i] + rollout.shift;
  const auto next = std::lower_bound(jumps.begin(), jumps.end(), t - width);
  return next != jumps.end() && *next <= t + width;
}

namespace {

/// Standard deviation of the quantisation of a log: its smallest step over sqrt(12). A coarse encoder repeats its
/// values, so that their differences alone would show no noise.
double quantisation(const std::vector<double>& x) {
  double step = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < x.size(); ++i)
    if (x[i] != x[i - 1]) step = std::min(step, std::abs(x[i] - x[i - 1]));
  return std::isfinite(step) ? step / std::sqrt(12.0) : 0;
}

}  // namespace

std::vector<double> noise_of(const DropSimulator& drops) {
  std::vector<double> out;
  for (std::size_t o = 0; o < drops.channels().size(); ++o) {
    double sum = 0, n = 0, largest = 0;
    for (std::size_t m = 0; m < drops.drops(); ++m) {
      std::vector<double> x;
      for (const double v : drops.log(m).output[o])
        if (std::isfinite(v)) x.push_back(v), largest = std::max(largest, std::abs(v));
      sum += double(x.size()) * std::pow(std::max(identify::noise_level(x), quantisation(x)), 2), n += double(x.size());
    }
    constexpr double kMinNoise = 1e-9;  // relative to the output, so that a log without noise has a finite weight
    out.push_back(n > 0 ? std::max({std::sqrt(sum / n), kMinNoise * largest, 1e-12}) : kNaN);
  }
  return out;
}

std::vector<double> rms_of(const std::vector<DropResult>& drops) {
  std::vector<double> out;
  for (std::size_t o = 0; !drops.empty() && o < drops[0].rms.size(); ++o) {
    double sum = 0, n = 0;
    for (const DropResult& d : drops)
      for (const bool used : d.used[o])
        if (used) n += 1, sum += d.rms[o] * d.rms[o];
    out.push_back(n > 0 ? std::sqrt(sum / n) : kNaN);
  }
  return out;
}

}  // namespace ukemi::tools

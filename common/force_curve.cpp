#include "common/force_curve.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/median.hpp"

namespace ukemi {

double value(const Cubic& c, double u) { return c[0] + u * (c[1] + u * (c[2] + u * c[3])); }

namespace {

double slope(const Cubic& c, double u) { return c[1] + u * (2 * c[2] + u * 3 * c[3]); }

/// The u nearest to 0, between 0 and `end`, where c(u) crosses `level`; none where it does not.
std::optional<double> first_crossing(const Cubic& c, double end, double level) {
  constexpr int kSubdivisions = 16, kBisections = 50;
  const auto above = [&](double u) { return value(c, u) > level; };
  const bool side = above(0);
  for (int k = 1; k <= kSubdivisions; ++k) {
    double far = end * k / kSubdivisions, near = end * (k - 1) / kSubdivisions;
    if (above(far) == side) continue;
    for (int i = 0; i < kBisections; ++i) {
      const double middle = 0.5 * (near + far);
      (above(middle) == side ? near : far) = middle;
    }
    return far;
  }
  return std::nullopt;
}

/// u where a force that is steep, rather than curved, at a pulse's end crosses rest beyond it; else none.
std::optional<double> sharp_onset(const Cubic& c, double interval, double rest) {
  constexpr double kMaxCurvature = 0.25;  // of f f'' / f'^2: 0 in a rise linear in time, 1/2 in a quadratic one
  if (!((c[0] - rest) * 2 * c[2] < kMaxCurvature * c[1] * c[1])) return std::nullopt;
  return first_crossing(c, interval, rest);
}

}  // namespace

Cubic shifted(const Cubic& c, double du) { return {value(c, du), slope(c, du), c[2] + 3 * c[3] * du, c[3]}; }

Cubic ForceCurve::linear(std::size_t k) const {
  const auto &t = samples_.t, &f = samples_.force;
  return {f[k], (f[k + 1] - f[k]) / (t[k + 1] - t[k]), 0, 0};
}

/// Cubic of an interval with these slopes at its ends, u from its start.
Cubic ForceCurve::hermite(std::size_t k, double first_slope, double last_slope) const {
  const Cubic straight = linear(k);
  const double h = samples_.t[k + 1] - samples_.t[k], a = first_slope - straight[1], b = last_slope - straight[1];
  return {straight[0], first_slope, -(2 * a + b) / h, (a + b) / (h * h)};
}

/// The slopes at the samples first .. last of the cubic spline through them: slope 0 at a clamped end, "not a
/// knot" at the others (the third derivative is continuous at the last sample but one).
std::vector<double> ForceCurve::spline(std::size_t first, std::size_t last, bool clamp_first, bool clamp_last) const {
  const std::size_t n = last - first + 1;
  std::vector<double> upper(n), right(n);  // after elimination: slope[i] + upper[i] slope[i + 1] = right[i]
  const auto h = [&](std::size_t i) { return samples_.t[first + i + 1] - samples_.t[first + i]; };
  const auto rate = [&](std::size_t i) { return linear(first + i)[1]; };
  const auto end = [&](double near, double far, double near_rate, double far_rate) {
    return ((near + 2 * (near + far)) * far * near_rate + near * near * far_rate) / (near + far);
  };
  if (!clamp_first) upper[0] = (h(0) + h(1)) / h(1), right[0] = end(h(0), h(1), rate(0), rate(1)) / h(1);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double before = 1 / h(i - 1), after = 1 / h(i), pivot = 2 * (before + after) - before * upper[i - 1];
    upper[i] = after / pivot;
    right[i] = (3 * (before * rate(i - 1) + after * rate(i)) - before * right[i - 1]) / pivot;
  }
  if (!clamp_last) {
    const double near = h(n - 2), far = h(n - 3), below = near + far;
    right[n - 1] = (end(near, far, rate(n - 2), rate(n - 3)) - below * right[n - 2]) / (far - below * upper[n - 2]);
  }
  for (std::size_t i = n - 1; i-- > 0;) right[i] -= upper[i] * right[i + 1];
  return right;
}

/// Appends a piece from t on, within an interval between two samples; `smooth` is F_smooth there, u from t.
void ForceCurve::add(std::size_t interval, double t, const Cubic& smooth) {
  const Cubic straight = shifted(linear(interval), t - samples_.t[interval]);
  Cubic c;
  for (std::size_t i = 0; i < c.size(); ++i) c[i] = straight[i] + *samples_.smooth * (smooth[i] - straight[i]);
  const bool was_at_rest = std::exchange(at_rest_, straight == rest() && smooth == rest());
  if (!(was_at_rest && at_rest_)) blended_.push_back({t, c});
}

/// Appends the interval before a pulse, or after it. The pulse begins or ends `crossing` [s] from its sample there,
/// where `end`, its curve with u from that sample, crosses rest; a straight line joins that to the sample next to it.
void ForceCurve::add_onset(std::size_t interval, const Cubic& end, double crossing, bool before) {
  const auto &t = samples_.t, &f = samples_.force;
  const double at = t[interval + (before ? 1 : 0)] + crossing;
  const auto line = [](double from, double to, double length) {
    return Cubic{from, length > 0 ? (to - from) / length : 0, 0, 0};
  };
  add(interval, t[interval], before ? line(f[interval], samples_.rest, at - t[interval]) : end);
  add(interval, at, before ? shifted(end, crossing) : line(samples_.rest, f[interval + 1], t[interval + 1] - at));
}

/// Whether no interval between these samples is much shorter or longer than their median: else a spline may overshoot.
bool ForceCurve::evenly_sampled(std::size_t first, std::size_t last) const {
  constexpr double kShort = 0.1, kLong = 2;
  std::vector<double> intervals;
  for (std::size_t i = first; i < last; ++i) intervals.push_back(samples_.t[i + 1] - samples_.t[i]);
  const auto [shortest, longest] = std::minmax_element(intervals.begin(), intervals.end());
  const double shortest_interval = *shortest, longest_interval = *longest, typical = median(std::move(intervals));
  return shortest_interval >= kShort * typical && longest_interval <= kLong * typical;
}

void ForceCurve::add_pulse(std::size_t first, std::size_t last) {
  constexpr std::size_t kMinSamples = 4;
  const std::size_t n = samples_.force.size();
  std::size_t from = first > 0 ? first - 1 : 0, to = std::min(last + 1, n - 1);
  if (last - first + 1 < kMinSamples || !evenly_sampled(from, to)) {
    for (std::size_t i = from; i < to; ++i) add(i, samples_.t[i], linear(i));
    return;
  }
  const std::vector<double> free = spline(first, last, false, false);
  const Cubic begin = hermite(first, free[0], free[1]),
              end = shifted(hermite(last - 1, free.end()[-2], free.end()[-1]), samples_.t[last] - samples_.t[last - 1]);
  const double rest = samples_.rest;
  const auto onset = from < first ? sharp_onset(begin, samples_.t[from] - samples_.t[first], rest) : std::nullopt,
             offset = to > last ? sharp_onset(end, samples_.t[to] - samples_.t[last], rest) : std::nullopt;
  const bool clamp_begin = from < first && !onset, clamp_end = to > last && !offset;  // with slope 0 at rest
  if (!clamp_begin) from = first;
  if (!clamp_end) to = last;
  const std::vector<double> slope = clamp_begin || clamp_end ? spline(from, to, clamp_begin, clamp_end) : free;
  if (onset) add_onset(first - 1, begin, *onset, true);
  for (std::size_t i = from; i < to; ++i) add(i, samples_.t[i], hermite(i, slope[i - from], slope[i - from + 1]));
  if (offset) add_onset(last, end, *offset, false);
}

Cubic ForceCurve::from(double t) const {
  const std::size_t n = pieces();
  if (n == 0 || t < begin(0)) return {samples_.force.front(), 0, 0, 0};
  if (t >= begin(n)) return {samples_.force.back(), 0, 0, 0};
  std::size_t first = 0;
  for (std::size_t last = n; last - first > 1;) {
    const std::size_t middle = first + (last - first) / 2;
    (begin(middle) <= t ? first : last) = middle;
  }
  return shifted(piece(first), t - begin(first));
}

ForceCurve::ForceCurve(const ForceSamples& samples) : samples_(samples) {
  const auto& f = samples_.force;
  if (!samples_.smooth || f.size() < 2) return;
  const auto off_rest = [&](std::size_t i) { return std::abs(f[i] - samples_.rest) > samples_.within; };
  for (std::size_t i = 0; i < f.size();) {
    if (!off_rest(i)) {
      const bool between = i + 1 < f.size() && !off_rest(i + 1);
      if (between && !(at_rest_ && linear(i) == rest())) add(i, samples_.t[i], linear(i));
      ++i;
      continue;
    }
    std::size_t last = i;
    while (last + 1 < f.size() && off_rest(last + 1)) ++last;
    add_pulse(i, last);
    i = last + 1;
  }
  blended_.push_back({samples_.t.back(), {}});
}

}  // namespace ukemi

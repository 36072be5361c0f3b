#include "common/force_curve.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/median.hpp"

namespace ukemi {

double value(const Cubic& c, double u) { return c[0] + u * (c[1] + u * (c[2] + u * c[3])); }

namespace {

double slope(const Cubic& c, double u) { return c[1] + u * (2 * c[2] + u * 3 * c[3]); }

/// The u between 0 and `end` that is nearest to 0 with c(u) = level; none where the curve stays on its side.
std::optional<double> first_meeting(const Cubic& c, double end, double level) {
  constexpr int kLooks = 16, kHalvings = 50;
  const auto above = [&](double u) { return value(c, u) > level; };
  const bool side = above(0);
  for (int k = 1; k <= kLooks; ++k) {
    double far = end * k / kLooks, near = end * (k - 1) / kLooks;
    if (above(far) == side) continue;
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = 0.5 * (near + far);
      (above(middle) == side ? near : far) = middle;
    }
    return far;
  }
  return std::nullopt;
}

/// Where a force that is steep, rather than bent, at a pulse's end meets rest beyond it.
std::optional<double> sharp_onset(const Cubic& c, double interval, double rest) {
  constexpr double kBent = 0.25;  // f f'' / f'^2: 0 where it rises like the time since its onset, 1/2 like its square
  if (!((c[0] - rest) * 2 * c[2] < kBent * c[1] * c[1])) return std::nullopt;
  return first_meeting(c, interval, rest);
}

}  // namespace

Cubic moved(const Cubic& c, double by) { return {value(c, by), slope(c, by), c[2] + 3 * c[3] * by, c[3]}; }

Cubic ForceCurve::linear(std::size_t k) const {
  const auto &t = samples_.t, &f = samples_.force;
  return {f[k], (f[k + 1] - f[k]) / (t[k + 1] - t[k]), 0, 0};
}

/// The cubic of an interval whose ends have these slopes, u from its begin.
Cubic ForceCurve::hermite(std::size_t k, double from, double to) const {
  const Cubic straight = linear(k);
  const double h = samples_.t[k + 1] - samples_.t[k], a = from - straight[1], b = to - straight[1];
  return {straight[0], from, -(2 * a + b) / h, (a + b) / (h * h)};
}

/// The slopes at the samples first .. last of the cubic spline through them. At an end that is held its slope is 0, at
/// the other ends the third derivative does not jump at the last sample but one ("not a knot").
std::vector<double> ForceCurve::spline(std::size_t first, std::size_t last, bool hold_first, bool hold_last) const {
  const std::size_t n = last - first + 1;
  std::vector<double> upper(n), right(n);  // after elimination: slope[i] + upper[i] slope[i + 1] = right[i]
  const auto h = [&](std::size_t i) { return samples_.t[first + i + 1] - samples_.t[first + i]; };
  const auto rate = [&](std::size_t i) { return linear(first + i)[1]; };
  const auto end = [&](double near, double far, double near_rate, double far_rate) {
    return ((near + 2 * (near + far)) * far * near_rate + near * near * far_rate) / (near + far);
  };
  if (!hold_first) upper[0] = (h(0) + h(1)) / h(1), right[0] = end(h(0), h(1), rate(0), rate(1)) / h(1);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double before = 1 / h(i - 1), after = 1 / h(i), pivot = 2 * (before + after) - before * upper[i - 1];
    upper[i] = after / pivot;
    right[i] = (3 * (before * rate(i - 1) + after * rate(i)) - before * right[i - 1]) / pivot;
  }
  if (!hold_last) {
    const double near = h(n - 2), far = h(n - 3), below = near + far;
    right[n - 1] = (end(near, far, rate(n - 2), rate(n - 3)) - below * right[n - 2]) / (far - below * upper[n - 2]);
  }
  for (std::size_t i = n - 1; i-- > 0;) right[i] -= upper[i] * right[i + 1];
  return right;
}

/// From t on, which lies in the interval between two samples, F_smooth is this curve, u from t on.
void ForceCurve::add(std::size_t interval, double t, const Cubic& smooth) {
  const Cubic straight = moved(linear(interval), t - samples_.t[interval]);
  Cubic c;
  for (std::size_t i = 0; i < c.size(); ++i) c[i] = straight[i] + *samples_.smooth * (smooth[i] - straight[i]);
  const bool rested = std::exchange(rests_, straight == rest() && smooth == rest());
  if (!(rested && rests_)) blended_.push_back({t, c});
}

/// The interval before a pulse, or after it: where `end`, the pulse's curve with u from its sample there, meets rest
/// the pulse begins or ends.
void ForceCurve::add_onset(std::size_t interval, const Cubic& end, double meets, bool before) {
  const double t = samples_.t[interval + (before ? 1 : 0)] + meets;
  add(interval, samples_.t[interval], before ? rest() : end);
  add(interval, t, before ? moved(end, meets) : rest());
}

/// Whether no interval between these samples is much shorter or longer than their median: a spline through others may
/// run far off.
bool ForceCurve::even(std::size_t first, std::size_t last) const {
  constexpr double kShort = 0.1, kLong = 2;
  std::vector<double> intervals;
  for (std::size_t i = first; i < last; ++i) intervals.push_back(samples_.t[i + 1] - samples_.t[i]);
  const auto [shortest, longest] = std::minmax_element(intervals.begin(), intervals.end());
  const double least = *shortest, most = *longest, usual = median(std::move(intervals));
  return least >= kShort * usual && most <= kLong * usual;
}

void ForceCurve::add_pulse(std::size_t first, std::size_t last) {
  constexpr std::size_t kFewest = 4;
  const std::size_t n = samples_.force.size();
  std::size_t from = first > 0 ? first - 1 : 0, to = std::min(last + 1, n - 1);
  if (last - first + 1 < kFewest || !even(from, to)) {
    for (std::size_t i = from; i < to; ++i) add(i, samples_.t[i], linear(i));
    return;
  }
  const std::vector<double> alone = spline(first, last, false, false);
  const Cubic begin = hermite(first, alone[0], alone[1]),
              end = moved(hermite(last - 1, alone.end()[-2], alone.end()[-1]), samples_.t[last] - samples_.t[last - 1]);
  const double rest = samples_.rest;
  const auto onset = from < first ? sharp_onset(begin, samples_.t[from] - samples_.t[first], rest) : std::nullopt,
             offset = to > last ? sharp_onset(end, samples_.t[to] - samples_.t[last], rest) : std::nullopt;
  const bool leaves = from < first && !onset, returns = to > last && !offset;  // with slope 0 at rest
  if (!leaves) from = first;
  if (!returns) to = last;
  const std::vector<double> slope = leaves || returns ? spline(from, to, leaves, returns) : alone;
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
  return moved(piece(first), t - begin(first));
}

ForceCurve::ForceCurve(const ForceSamples& samples) : samples_(samples) {
  const auto& f = samples_.force;
  if (!samples_.smooth || f.size() < 2) return;
  const auto off_rest = [&](std::size_t i) { return f[i] != samples_.rest; };
  for (std::size_t i = 0; i < f.size();) {
    if (!off_rest(i)) {
      if (!rests_ && i + 1 < f.size() && !off_rest(i + 1)) add(i, samples_.t[i], rest());
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

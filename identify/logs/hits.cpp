#include "identify/logs/hits.hpp"

#include <algorithm>
#include <cmath>

#include "common/noise.hpp"
#include "identify/logs/trial_checks.hpp"

namespace ukemi::identify {

namespace {

constexpr double kDetection = 5;  // what a hit exceeds, in standard deviations of the force's noise

/// Whether a sample of the force is above a twentieth of its maximum, and above `noise`.
auto is_pulse(const std::vector<double>& force, double noise = 0) {
  const double small = std::max(0.05 * largest_deviation(force), noise);
  return [small](double f) { return std::abs(f) > small; };
}

/// Number of samples before the first pulse, less a fifth, which may hold its rise.
std::size_t samples_at_rest(const std::vector<double>& force) {
  const auto first = std::find_if(force.begin(), force.end(), is_pulse(force, kDetection * noise_level(force)));
  return first == force.end() ? 0 : 4 * std::size_t(first - force.begin()) / 5;
}

double mean(const std::vector<double>& x, std::size_t count) {
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i) sum += x[i];
  return sum / double(count);
}

/// Sum of the squared distances of the first samples from a level.
double squares(const std::vector<double>& x, std::size_t count, double level) {
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i) sum += (x[i] - level) * (x[i] - level);
  return sum;
}

/// The samples of a force outside of hits.
std::vector<double> between(const std::vector<double>& force, const std::vector<LoggedHit>& hits) {
  std::vector<double> out;
  auto next = force.begin();
  for (const LoggedHit& h : hits) {
    out.insert(out.end(), next, force.begin() + long(h.first));
    next = force.begin() + long(h.last) + 1;
  }
  out.insert(out.end(), next, force.end());
  return out;
}

const std::vector<double>& force_times(const Trial& trial) { return trial.force_t.empty() ? trial.t : trial.force_t; }

}  // namespace

std::vector<LoggedHit> hits(const Trial& trial, double noise, double rest) {
  const std::vector<double>& f = trial.force;
  std::vector<LoggedHit> out;
  for (std::size_t i = 0; i < f.size(); ++i) {
    if (!(std::abs(f[i] - rest) > kDetection * noise)) continue;
    const auto acts = [&](std::size_t k) {
      return std::abs(f[k] - rest) > kHitEnd * noise && (f[k] > rest) == (f[i] > rest);
    };
    LoggedHit hit{i, i};
    const std::size_t earliest = out.empty() ? 0 : out.back().last + 1;
    while (hit.first > earliest && acts(hit.first)) --hit.first;
    while (hit.last + 1 < f.size() && acts(hit.last)) ++hit.last;
    if (!out.empty() && out.back().last + 1 == hit.first)
      out.back().last = hit.last;
    else
      out.push_back(hit);
    i = hit.last;
  }
  return out;
}

double force_noise_before_first_hit(const Trial& trial) {
  constexpr std::size_t kMinSamples = 9;
  const std::size_t n = samples_at_rest(trial.force);
  if (n < kMinSamples) return 0;
  const double level = mean(trial.force, n);
  const double square = squares(trial.force, n, level);
  double steps = 0;
  for (std::size_t i = 1; i < n; ++i) steps += std::pow(trial.force[i] - trial.force[i - 1], 2);
  // A step of white noise has twice its variance; of a smoothly rising force much less.
  return steps > 0.5 * square ? std::sqrt(square / double(n - 1)) : 0;
}

void flatten_force_between_hits(Trial& trial, std::optional<double> noise) {
  if (trial.force.empty()) return;
  double sigma = noise ? *noise : force_noise_before_first_hit(trial);
  if (!(sigma > 0)) return;
  const std::size_t n = samples_at_rest(trial.force);
  double rest = n > 0 ? mean(trial.force, n) : 0;
  // The samples before the first hit locate the hits; all samples between hits then give noise and rest better.
  constexpr double kMaxRatio = 2;  // of what is removed, over the noise before the first hit
  const double max_noise = kMaxRatio * sigma;
  std::size_t at_rest = 0;
  for (int pass = 0; pass < 3; ++pass) {
    const std::vector<double> resting = between(trial.force, hits(trial, sigma, rest));
    at_rest = resting.size();
    if (at_rest == 0) break;
    rest = mean(resting, at_rest);
    const double square = squares(resting, at_rest, rest);
    if (square > max_noise * max_noise * double(at_rest)) return;
    if (!noise && square > 0) sigma = std::sqrt(square / double(at_rest));
  }
  const std::vector<LoggedHit> found = hits(trial, sigma, rest);
  if (std::abs(rest) <= 4 * sigma / std::sqrt(double(at_rest))) rest = 0;
  std::vector<double> flattened(trial.force.size(), rest);
  for (const LoggedHit& h : found)
    std::copy(trial.force.begin() + long(h.first), trial.force.begin() + long(h.last) + 1,
              flattened.begin() + long(h.first));
  trial.force = std::move(flattened);
  trial.force_noise = sigma, trial.force_rest = rest;
}

int shortest_pulse(const Trial& trial) {
  const std::vector<double>& f = trial.force;
  const auto acts = is_pulse(f);
  long shortest = 0;
  for (auto end = f.begin();;) {
    const auto begin = std::find_if(end, f.end(), acts);
    if (begin == f.end()) return int(shortest);
    end = std::find_if_not(begin, f.end(), acts);
    shortest = shortest == 0 ? end - begin : std::min(shortest, end - begin);
  }
}

std::vector<Gap> gaps(const Trial& trial) {
  std::vector<Gap> out;
  const auto find_gaps = [&](const std::vector<double>& t) {
    if (t.size() < 3) return;
    std::vector<double> intervals;
    for (std::size_t i = 0; i + 1 < t.size(); ++i) intervals.push_back(t[i + 1] - t[i]);
    const auto quantile_95 = intervals.begin() + long(0.95 * double(intervals.size() - 1));
    std::nth_element(intervals.begin(), quantile_95, intervals.end());
    const double threshold = 1.5 * *quantile_95;
    const std::vector<double>& ft = force_times(trial);
    const double acting = std::max(0.005 * largest_deviation(trial.force), 5 * trial.force_noise);
    for (std::size_t i = 0; i + 1 < t.size(); ++i) {
      if (t[i + 1] - t[i] < threshold) continue;
      bool acts = false;  // from the last sample of the force before the gap to the first after it
      auto k = std::size_t(std::upper_bound(ft.begin(), ft.end(), t[i]) - ft.begin());
      for (k = k > 0 ? k - 1 : 0; k < trial.force.size(); ++k) {
        acts = acts || std::abs(trial.force[k]) > acting;
        if (ft[k] >= t[i + 1]) break;
      }
      out.push_back({t[i], t[i + 1] - t[i], acts ? Gap::Place::kInHit : Gap::Place::kAtRest});
    }
  };
  find_gaps(trial.t);
  if (!trial.force_t.empty()) find_gaps(trial.force_t);
  return out;
}

std::optional<double> first_hit_correlation(const Trial& trial) {
  if (trial.force.empty() || trial.phi.size() < 9) return std::nullopt;
  const std::vector<double> force = force_at_samples(trial);
  const auto first = std::find_if(force.begin(), force.end(), is_pulse(force));
  if (first == force.end()) return std::nullopt;
  const auto last = std::find_if_not(
      first, force.end(), [&, acts = is_pulse(force)](double f) { return acts(f) && (f > 0) == (*first > 0); });
  const auto begin = std::size_t(first - force.begin()), end = std::size_t(last - force.begin());
  const std::vector<double>& ref = trial.phi_ref;
  for (std::size_t i = 0; i < end && i < ref.size(); ++i)
    if (ref[i] != ref[0]) return std::nullopt;
  const double start = mean(trial.phi, begin > 0 ? begin : 1);
  double cross = 0, force_square = 0, angle_square = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const double angle = trial.phi[i] - start;
    cross += force[i] * angle, force_square += force[i] * force[i], angle_square += angle * angle;
  }
  const double noise = noise_level(trial.phi);
  if (!(angle_square > 25 * noise * noise * double(end - begin))) return std::nullopt;
  return cross / std::sqrt(force_square * angle_square);
}

}  // namespace ukemi::identify

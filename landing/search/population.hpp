// What the population-based solvers share: random points, differential evolution.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "common/random.hpp"
#include "landing/search/objective.hpp"

namespace ukemi::landing {

inline constexpr int kBatch = 32;  ///< candidates played at once: a multiple of every lane count

/// A uniform point of the unit cube.
inline Candidate random_point(Random& r, int dimension) {
  Candidate p{Coordinates(dimension)};
  for (double& u : p.u) u = r.uniform();
  return p;
}
/// Uniform in the cube of these variables; with probability `neutral` every variable that has a neutral value takes it:
/// motions without shape terms and gains are often the ones that keep the ratings.
inline Candidate random_point(Random& r, const std::vector<Variable>& variables, double neutral) {
  Candidate p = random_point(r, int(variables.size()));
  const auto has_neutral = [](auto& v) { return v.neutral && *v.neutral >= v.lower && *v.neutral <= v.upper; };
  if (std::none_of(variables.begin(), variables.end(), has_neutral) || r.uniform() >= neutral) return p;
  for (std::size_t k = 0; k < variables.size(); ++k)
    if (const Variable& v = variables[k]; has_neutral(v) && v.upper > v.lower)
      p.u[long(k)] = (*v.neutral - v.lower) / (v.upper - v.lower);
  return p;
}
/// A uniform index below n.
inline int random_index(Random& r, int n) { return std::min(n - 1, int(r.uniform() * n)); }
/// A random index below n (0 where n is 0), lower ones with higher probability.
inline std::size_t biased_index(Random& r, std::size_t n) { return std::size_t(r.uniform() * r.uniform() * double(n)); }

/// Side of the smallest cube that contains all points.
inline double spread(std::span<const Candidate> points) {
  double widest = 0;
  for (int k = 0; k < points[0].u.size(); ++k) {
    double low = 1, high = 0;
    for (const Candidate& p : points) low = std::min(low, p.u[k]), high = std::max(high, p.u[k]);
    widest = std::max(widest, high - low);
  }
  return widest;
}

/// A normal sample around a point, without a bound; `sigma` as a fraction of the box.
inline Candidate perturbed(Candidate p, double sigma, Random& r) {
  p.bound = kNoMotion;
  for (double& u : p.u) u = std::clamp(u + sigma * r.normal(), 0.0, 1.0);
  return p;
}

/// Normal samples around a point, sigma from 0.02 down to 0.0002 of the box; the point itself comes first.
inline void sample_around(const Candidate& centre, Random& r, std::vector<Candidate>& population) {
  for (Candidate& p : population)
    p = perturbed(centre, &p == &population.front() ? 0 : 0.02 * std::pow(10.0, -2 * r.uniform()), r);
}

/// Settings of a generation of differential evolution.
struct DifferentialSettings {
  double factor_low = 0.2, factor_high = 0.8;  ///< F is drawn between them for every trial (dither)
  double crossover = 0.9;                      ///< CR
  int leaders = 1;                             ///< the base vector is one of this many best
};

/// One generation of best/1/bin: a trial for every member, bounded by its value, replaces it where it is not worse.
/// `evaluate(trials)` sets the values. `trials`: a buffer of the population's size; nothing is allocated.
template <class Evaluate>
void evolve(Evaluate&& evaluate, Random& r, std::span<Candidate> population, std::span<Candidate> trials,
            const DifferentialSettings& settings) {
  const int n = int(population.size());
  std::partial_sort(population.begin(), population.begin() + std::min(n, settings.leaders), population.end());
  for (int i = 0; i < n; ++i) {
    const Candidate& parent = population[std::size_t(i)];
    Candidate& trial = trials[std::size_t(i)] = parent;
    const double f = r.uniform(settings.factor_low, settings.factor_high);
    const auto& base = population[std::size_t(random_index(r, settings.leaders))].u;
    int a = 0, b = 0;
    do a = random_index(r, n);
    while (a == i);
    do b = random_index(r, n);
    while (b == i || b == a);
    const auto& ua = population[std::size_t(a)].u;
    const auto& ub = population[std::size_t(b)].u;
    const int forced = random_index(r, int(base.size()));
    for (int k = 0; k < base.size(); ++k) {
      if (k != forced && r.uniform() >= settings.crossover) continue;
      const double x = base[k] + f * (ua[k] - ub[k]);
      trial.u[k] = x < 0   ? 0.5 * parent.u[k]
                   : x > 1 ? 0.5 * (1 + parent.u[k])
                           : x;  // half way between the parent and the face
    }
    trial.bound = parent.value;
  }
  evaluate(trials);
  for (int i = 0; i < n; ++i)
    if (trials[std::size_t(i)].value <= population[std::size_t(i)].value)
      population[std::size_t(i)] = trials[std::size_t(i)];
}

}  // namespace ukemi::landing

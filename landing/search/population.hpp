// What the population-based solvers share: random points, differential evolution.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "common/random.hpp"
#include "landing/search/objective.hpp"

namespace ukemi::landing {

inline constexpr int kBatch = 32;  ///< candidates played at once: whole packs of lanes, however wide

/// A uniform point of the cube of so many variables.
inline Candidate random_point(Random& r, int dimension) {
  Candidate p{Coordinates(dimension)};
  for (double& u : p.u) u = r.uniform();
  return p;
}
/// Uniform in the cube of these variables; with the probability `plain` those with a neutral value take that value,
/// where there are such: within ratings the motions that keep them are often the plain ones.
inline Candidate point_of(Random& r, const std::vector<Variable>& variables, double plain) {
  Candidate p = random_point(r, int(variables.size()));
  const auto inside = [](const Variable& v) { return v.neutral && *v.neutral >= v.lower && *v.neutral <= v.upper; };
  if (std::none_of(variables.begin(), variables.end(), inside) || r.uniform() >= plain) return p;
  for (std::size_t k = 0; k < variables.size(); ++k)
    if (const Variable& v = variables[k]; inside(v) && v.upper > v.lower)
      p.u[long(k)] = (*v.neutral - v.lower) / (v.upper - v.lower);
  return p;
}
/// An index below n.
inline int random_index(Random& r, int n) { return std::min(n - 1, int(r.uniform() * n)); }
/// An index below n (0 where n is 0), the lower the likelier.
inline std::size_t low_index(Random& r, std::size_t n) { return std::size_t(r.uniform() * r.uniform() * double(n)); }

/// Side of the smallest cube that holds them all.
inline double spread(std::span<const Candidate> points) {
  double widest = 0;
  for (int k = 0; k < points[0].u.size(); ++k) {
    double low = 1, high = 0;
    for (const Candidate& p : points) low = std::min(low, p.u[k]), high = std::max(high, p.u[k]);
    widest = std::max(widest, high - low);
  }
  return widest;
}

/// A point close to another, to be followed to its end: normal, `size` in parts of the box.
inline Candidate beside(Candidate p, double size, Random& r) {
  p.bound = kNoMotion;
  for (double& u : p.u) u = std::clamp(u + size * r.normal(), 0.0, 1.0);
  return p;
}

/// A population close to a point: normal, with sizes from 0.02 down to 0.0002 of the box; the point itself comes first.
inline void scatter(const Candidate& centre, Random& r, std::vector<Candidate>& population) {
  for (Candidate& p : population)
    p = beside(centre, &p == &population.front() ? 0 : 0.02 * std::pow(10.0, -2 * r.uniform()), r);
}

/// Differential evolution's choices for one generation.
struct Differential {
  double factor_low = 0.2, factor_high = 0.8;  ///< F is drawn between them for every trial (dither)
  double crossover = 0.9;                      ///< CR
  int leaders = 1;                             ///< the base is one of this many best
};

/// One generation of best/1/bin: a trial for every member, played only until it is worse than its parent, and taken in
/// its place if it is not. `trials` is scratch of the population's size; nothing is allocated. `play` evaluates them.
template <class DrivenMotion>
void evolve(DrivenMotion&& play, Random& r, std::span<Candidate> population, std::span<Candidate> trials,
            const Differential& choice) {
  const int n = int(population.size());
  std::partial_sort(population.begin(), population.begin() + std::min(n, choice.leaders), population.end());
  for (int i = 0; i < n; ++i) {
    const Candidate& parent = population[std::size_t(i)];
    Candidate& trial = trials[std::size_t(i)] = parent;
    const double f = r.uniform(choice.factor_low, choice.factor_high);
    const auto& base = population[std::size_t(random_index(r, choice.leaders))].u;
    int a = 0, b = 0;
    do a = random_index(r, n);
    while (a == i);
    do b = random_index(r, n);
    while (b == i || b == a);
    const auto& ua = population[std::size_t(a)].u;
    const auto& ub = population[std::size_t(b)].u;
    const int sure = random_index(r, int(base.size()));
    for (int k = 0; k < base.size(); ++k) {
      if (k != sure && r.uniform() >= choice.crossover) continue;
      const double x = base[k] + f * (ua[k] - ub[k]);
      trial.u[k] = x < 0   ? 0.5 * parent.u[k]
                   : x > 1 ? 0.5 * (1 + parent.u[k])
                           : x;  // back inside the cube, half way to the edge
    }
    trial.bound = parent.value;
  }
  play(trials);
  for (int i = 0; i < n; ++i)
    if (trials[std::size_t(i)].value <= population[std::size_t(i)].value)
      population[std::size_t(i)] = trials[std::size_t(i)];
}

}  // namespace ukemi::landing

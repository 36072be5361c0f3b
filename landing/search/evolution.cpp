// Peers that evaluate in batches: differential evolution, the paper's GA and pattern search, random search.
#include "landing/search/population.hpp"
#include "landing/search/search.hpp"
#include "landing/search/solvers.hpp"

namespace ukemi::landing {

namespace {
constexpr int kBatch = 32;

std::vector<Point3> random_population(Search& search, Random& r, int n) {
  std::vector<Point3> population;
  for (int i = 0; i < n; ++i) population.push_back(random_point(r));
  search.evaluate(population);
  return population;
}
}  // namespace

void random_search(Search& search) {
  Random r(search.seed);
  std::vector<Point3> points(kBatch);
  while (!search.over()) {
    for (Point3& p : points) p = random_point(r), p.bound = search.best().value;
    search.evaluate(points);
  }
}

void differential_evolution(Search& search) {
  constexpr int kPopulation = 40;
  constexpr double kConverged = 1e-7;
  Random r(search.seed);
  std::vector<Point3> trials(kPopulation);
  while (!search.over()) {
    std::vector<Point3> population = random_population(search, r, kPopulation);
    while (!search.over() && spread(population) > kConverged)
      evolve([&](std::span<Point3> p) { search.evaluate(p); }, r, population, trials,
             {.factor_low = 0.3, .factor_high = 0.9});
  }
}

void genetic_algorithm(Search& search) {
  constexpr int kPopulation = 50;  // MATLAB's default for few variables
  constexpr double kCrossover = 0.8, kBlend = 0.5;
  Random r(search.seed);
  std::vector<Point3> population = random_population(search, r, kPopulation), children(kPopulation);
  for (double sigma = 0.2; !search.over(); sigma = std::max(1e-4, 0.97 * sigma)) {
    const auto elite = *std::min_element(population.begin(), population.end());
    const auto parent = [&]() -> const Point3& {
      const Point3 &a = population[std::size_t(random_index(r, kPopulation))],
                   &b = population[std::size_t(random_index(r, kPopulation))];
      return a.value <= b.value ? a : b;
    };
    for (Point3& child : children) {
      const Point3 &a = parent(), &b = parent();
      child = a;
      child.bound = kNoMotion;
      for (std::size_t k = 0; k < 3; ++k) {
        double x = a.u[k];
        if (r.uniform() < kCrossover) x += r.uniform(-kBlend, 1 + kBlend) * (b.u[k] - a.u[k]);
        if (r.uniform() < 1.0 / 3) x += sigma * r.normal();
        child.u[k] = std::clamp(x, 0.0, 1.0);
      }
    }
    search.evaluate(children);
    std::swap(population, children);
    *std::max_element(population.begin(), population.end()) = elite;
  }
}

void pattern_search(Search& search) {
  constexpr double kFirst = 0.25, kFinest = 1e-7;
  Random r(search.seed);
  std::vector<Point3> poll(6);
  for (bool first = true; !search.over(); first = false) {
    Point3 at;
    if (!first) at = random_point(r);
    search.evaluate({&at, 1});
    for (double mesh = kFirst; mesh > kFinest && !search.over();) {
      for (int i = 0; i < 6; ++i) {
        Point3& p = poll[std::size_t(i)] = at;
        double& u = p.u[std::size_t(i / 2)];
        u = std::clamp(u + (i % 2 ? -mesh : mesh), 0.0, 1.0);
        p.bound = at.value;
      }
      search.evaluate(poll);
      const Point3& best = *std::min_element(poll.begin(), poll.end());
      const bool success = best.value < at.value;
      if (success) at = best;
      mesh *= success ? 2 : 0.5;
      mesh = std::min(mesh, kFirst);
    }
  }
}

}  // namespace ukemi::landing

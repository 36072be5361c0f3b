// Solvers that evaluate in batches: differential evolution, covariance matrix adaptation, the paper's GA and pattern
// search, random search.
#include "landing/search/cma.hpp"
#include "landing/search/population.hpp"
#include "landing/search/search.hpp"
#include "landing/search/solvers.hpp"

namespace ukemi::landing {

namespace {
std::vector<Candidate> random_population(Search& search, Random& r, int n) {
  std::vector<Candidate> population;
  for (int i = 0; i < n; ++i) population.push_back(random_point(r, search.dimension()));
  search.evaluate(population);
  return population;
}
}  // namespace

void random_search(Search& search) {
  Random r(search.seed);
  std::vector<Candidate> points(kBatch);
  while (!search.over()) {
    for (Candidate& p : points) p = random_point(r, search.dimension()), p.bound = search.best().value;
    search.evaluate(points);
  }
}

void differential_evolution(Search& search) {
  constexpr int kPopulation = 40;
  constexpr double kConverged = 1e-7;
  Random r(search.seed);
  std::vector<Candidate> trials(kPopulation);
  while (!search.over()) {
    std::vector<Candidate> population = random_population(search, r, kPopulation);
    while (!search.over() && spread(population) > kConverged)
      evolve([&](std::span<Candidate> p) { search.evaluate(p); }, r, population, trials,
             {.factor_low = 0.3, .factor_high = 0.9});
  }
}

void covariance_adaptation(Search& search) {
  constexpr int kSize = 16;
  constexpr double kInitial = 0.2, kConverged = 1e-7;
  Random r(search.seed);
  CovarianceAdaptation distribution;
  std::vector<Candidate> points(kSize);
  for (Candidate start = search.centre(); !search.over(); start = random_point(r, search.dimension())) {
    distribution.start(start.u, kInitial, kSize);
    while (!search.over() && distribution.largest_deviation() > kConverged) {
      std::fill(points.begin(), points.end(), search.centre());
      distribution.sample(r, points);
      search.evaluate(points);
      (void)distribution.update(points);
    }
  }
}

void genetic_algorithm(Search& search) {
  constexpr int kPopulation = 50;  // MATLAB's default for few variables
  constexpr double kCrossover = 0.8, kBlend = 0.5;
  Random r(search.seed);
  std::vector<Candidate> population = random_population(search, r, kPopulation), children(kPopulation);
  for (double sigma = 0.2; !search.over(); sigma = std::max(1e-4, 0.97 * sigma)) {
    const auto elite = *std::min_element(population.begin(), population.end());
    const auto parent = [&]() -> const Candidate& {
      const Candidate &a = population[std::size_t(random_index(r, kPopulation))],
                      &b = population[std::size_t(random_index(r, kPopulation))];
      return a.value <= b.value ? a : b;
    };
    for (Candidate& child : children) {
      const Candidate &a = parent(), &b = parent();
      child = a;
      child.bound = kNoMotion;
      for (int k = 0; k < child.u.size(); ++k) {
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
  constexpr double kCoarsest = 0.25, kFinest = 1e-7;
  Random r(search.seed);
  const int directions = 2 * search.dimension();
  std::vector<Candidate> poll(std::size_t(directions), search.centre());
  for (bool first = true; !search.over(); first = false) {
    Candidate incumbent = first ? search.centre() : random_point(r, search.dimension());
    search.evaluate({&incumbent, 1});
    for (double mesh = kCoarsest; mesh > kFinest && !search.over();) {
      for (int i = 0; i < directions; ++i) {
        Candidate& p = poll[std::size_t(i)] = incumbent;
        double& u = p.u[i / 2];
        u = std::clamp(u + (i % 2 ? -mesh : mesh), 0.0, 1.0);
        p.bound = incumbent.value;
      }
      search.evaluate(poll);
      const Candidate& best = *std::min_element(poll.begin(), poll.end());
      const bool success = best.value < incumbent.value;
      if (success) incumbent = best;
      mesh *= success ? 2 : 0.5;
      mesh = std::min(mesh, kCoarsest);
    }
  }
}

}  // namespace ukemi::landing

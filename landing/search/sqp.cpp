// The paper's SQP on a differentiable form: min s subject to a_k(x) <= s over the largest peaks a_k of the landings of
// a motion, each with its exact derivatives (Objective::linearise).
#include <algorithm>

#include "landing/search/nlopt_solver.hpp"
#include "landing/search/population.hpp"
#include "landing/search/scouts.hpp"
#include "landing/search/solvers.hpp"

namespace ukemi::landing {

Candidate descend_by_gradient(Search& search, Fidelity fidelity, const Candidate& start) {
  constexpr double kConverged = 1e-7;
  Objective& objective = search.objective();
  const auto n = std::size_t(search.dimension()), rows = std::size_t(objective.gradient_rows(fidelity));
  Candidate best = start;
  const auto peaks = [&](const double* u, double* a, double* gradient) {
    Candidate p = search.centre();
    std::copy_n(u, n, p.u.begin());
    search.evaluate({&p, 1}, fidelity);
    best = std::min(best, p);
    objective.linearise(p.u, fidelity, {a, rows}, {gradient, rows * n});
    return !search.over();
  };
  minimize_epigraph({int(rows),
                     peaks,
                     std::vector<double>(n, 0),
                     std::vector<double>(n, 1),
                     {start.u.begin(), start.u.end()},
                     start.value},
                    kConverged);
  return best;
}

namespace {

/// Repeats: scouts, then a descent from each of the best that lie apart. Most uniform starts are at cliffs.
void descend_from_scouts(Search& search) {
  constexpr long kMotions = 1'500;
  constexpr std::size_t kStarts = 16, kDescents = 6;
  constexpr double kApart = 0.1;  // fraction of the box
  constexpr Scouting kScouting{.uniform = 0.5, .nearest = -2, .farthest = -0.6, .neutral = 0.1};
  Random random(search.seed);
  Archive starts(kStarts, kApart);
  std::vector<Candidate> batch;
  for (; !search.over(); starts.clear()) {
    for (long n = 0; n < kMotions && !search.over(); n += kBatch)
      scout(search, random, kScouting, Goal::kPeak, starts, batch);
    for (std::size_t i = 0; i < std::min(kDescents, starts.size()) && !search.over(); ++i) {
      Candidate start = starts[i];
      start.bound = kNoMotion;
      search.evaluate({&start, 1});
      descend_by_gradient(search, search.objective().goal(), start);
    }
  }
}

}  // namespace

void sequential_quadratic(Search& search) {
  constexpr std::size_t kDrops = 32;  // under scatter: sample average approximation, a smooth function
  const Goal goal = search.objective().goal();
  const Fidelity fidelity = goal == Goal::kRobust ? Fidelity(goal, kDrops) : Fidelity(goal);
  if (goal != Goal::kRobust && search.dimension() > kPaperVariables) return descend_from_scouts(search);
  for (std::uint64_t restart = 0; !search.over(); ++restart) {
    Random random(search.seed, restart);
    Candidate start = restart == 0 ? search.centre() : random_point(random, search.dimension());
    search.evaluate({&start, 1}, fidelity);
    Candidate best = descend_by_gradient(search, fidelity, start);
    if (goal != Goal::kRobust) continue;
    best.bound = kNoMotion;  // over all drops
    search.evaluate({&best, 1});
  }
}

}  // namespace ukemi::landing

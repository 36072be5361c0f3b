// The paper's SQP on a form that it can differentiate: min s subject to a_k(x) <= s over the largest local maxima a_k
// of the landing (or of the landings of the execution box), each with its exact gradient (gradient.hpp).
#include <algorithm>
#include <cmath>

#include "landing/derivatives/gradient.hpp"
#include "landing/search/nlopt_solver.hpp"
#include "landing/search/population.hpp"
#include "landing/search/solvers.hpp"

namespace ukemi::landing {

void sequential_quadratic(Search& search) {
  const Objective& objective = search.objective();
  const bool tolerant = objective.options().goal == Goal::kTolerant;
  const int boxes = tolerant ? kExecutionPoints : 1, each = tolerant ? 2 : 6, count = boxes * each;
  const SearchRange& range = objective.scene().search;
  const Eigen::Vector3d scale(range.phi[1] - range.phi[0], range.phi[1] - range.phi[0],
                              range.duration[1] - range.duration[0]);
  // Padded to a fixed number: where there are fewer, a constraint that is always kept.
  const auto peaks = [&](const double* u, double* a, double* gradient) {
    Point3 p;
    std::copy(u, u + 3, p.u.begin());
    search.evaluate({&p, 1});
    std::fill(a, a + count, 0.0);
    std::fill(gradient, gradient + 3 * count, 0.0);
    const Motion m = objective.motion(p);
    for (int k = 0; k < boxes && !search.over(); ++k) {
      const auto found = motion_peaks(objective.scene(), objective.sea(),
                                      tolerant ? execution_point(m, objective.scene().execution, k) : m,
                                      {.accuracy = objective.accuracy(), .over = objective.over()}, each);
      search.spend(found.work);
      for (std::size_t i = 0; i < found.peaks.size(); ++i) {
        const auto row = std::size_t(k * each) + i;
        if (!std::isfinite(found.peaks[i].value) || !found.peaks[i].d.allFinite()) continue;
        a[row] = found.peaks[i].value;
        Eigen::Map<Eigen::Vector3d>(gradient + 3 * row) = found.peaks[i].d.cwiseProduct(scale);
      }
    }
    return !search.over();
  };
  for (std::uint64_t restart = 0; !search.over(); ++restart) {
    Random random(search.seed, restart);
    Point3 start;
    if (restart > 0) start = random_point(random);
    search.evaluate({&start, 1});
    minimize_epigraph({count, peaks, {0, 0, 0}, {1, 1, 1}, {start.u.begin(), start.u.end()}, start.value}, 1e-7);
  }
}

}  // namespace ukemi::landing

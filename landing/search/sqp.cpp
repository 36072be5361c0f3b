// The paper's SQP on a form that it can differentiate: min s subject to a_k(x) <= s over the largest local maxima a_k
// of the landing (or of the landings of the execution box), each with its exact gradient (gradient.hpp).
#include <algorithm>
#include <cmath>

#include "landing/derivatives/gradient.hpp"
#include "landing/search/nlopt_solver.hpp"
#include "landing/search/population.hpp"
#include "landing/search/solvers.hpp"

namespace ukemi::landing {

namespace {

/// The largest local maxima of a play, and their gradients by its numbers (landing/model/motion_space.hpp).
struct Peaks {
  std::vector<std::pair<double, Eigen::Matrix<double, kPlayNumbers, 1>>> largest;
  integrate::Counters work;
};

/// `last`: the last of the play's numbers that anything depends on; fewer derivatives take less time.
Peaks peaks_of(const Scene& scene, const Play& play, const SimulateOptions& options, int most, int last) {
  Peaks out;
  const auto take = [&](const auto& found) {
    out.work = found.work;
    for (const auto& p : found.peaks) {
      Eigen::Matrix<double, kPlayNumbers, 1> d = Eigen::Matrix<double, kPlayNumbers, 1>::Zero();
      const int motion = std::min(int(p.d.size()), kMotionNumbers);
      d.head(motion) = p.d.head(motion);
      if (p.d.size() > kMotionNumbers) d.template tail<5>() = p.d.template tail<5>();
      out.largest.emplace_back(p.value, d);
    }
  };
  if (last < kQuinticParameters)
    take(quintic_peaks(scene, play.sea, play.motion, options, most));
  else if (last < kMotionNumbers)
    take(motion_peaks(scene, play.sea, play.motion, options, most));
  else
    take(all_gradients(scene, play.sea, play.motion, options, most));
  return out;
}

}  // namespace

void sequential_quadratic(Search& search) {
  const Objective& objective = search.objective();
  const MotionSpace& space = objective.space();
  const bool tolerant = objective.options().goal == Goal::kTolerant;
  const int boxes = tolerant ? kExecutionPoints : 1, each = tolerant ? 2 : 6, count = boxes * each;
  const int n = space.dimension();
  Eigen::VectorXd range(n);
  for (int k = 0; k < n; ++k)
    range[k] = space.variables()[std::size_t(k)].upper - space.variables()[std::size_t(k)].lower;
  // Padded to a fixed number: where there are fewer, a constraint that is always kept.
  const auto peaks = [&](const double* u, double* a, double* gradient) {
    Candidate p = search.nothing();
    std::copy_n(u, n, p.u.begin());
    search.evaluate({&p, 1});
    std::fill(a, a + count, 0.0);
    std::fill(gradient, gradient + n * count, 0.0);
    const Coordinates x = space.values(p.u);
    const Play play = space.play(x);
    const Eigen::MatrixXd jacobian = space.jacobian(x);
    int last = kPlayNumbers - 1;
    while (last > 0 && jacobian.row(last).isZero(0)) --last;
    for (int k = 0; k < boxes && !search.over(); ++k) {
      const Play at = space.execution_point(play, objective.scene().execution, k);
      const Peaks found =
          peaks_of(objective.scene(), at, {.accuracy = objective.accuracy(), .over = objective.over()}, each, last);
      search.spend(found.work);
      for (std::size_t i = 0; i < found.largest.size(); ++i) {
        const auto row = std::size_t(k * each) + i;
        const auto& [value, d] = found.largest[i];
        if (!std::isfinite(value) || !d.allFinite()) continue;
        a[row] = value;
        Eigen::Map<Eigen::VectorXd>(gradient + std::size_t(n) * row, n) =
            (jacobian.transpose() * d).cwiseProduct(range);
      }
    }
    return !search.over();
  };
  for (std::uint64_t restart = 0; !search.over(); ++restart) {
    Random random(search.seed, restart);
    Candidate start = restart == 0 ? search.nothing() : random_point(random, n);
    search.evaluate({&start, 1});
    minimize_epigraph({count,
                       peaks,
                       std::vector<double>(std::size_t(n), 0),
                       std::vector<double>(std::size_t(n), 1),
                       {start.u.begin(), start.u.end()},
                       start.value},
                      1e-7);
  }
}

}  // namespace ukemi::landing

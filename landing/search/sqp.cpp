// The paper's SQP on a differentiable form: min s subject to a_k(x) <= s over the largest local maxima a_k
// of the landing (or of the landings of the execution box), each with its exact gradient (gradient.hpp).
#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/parallel.hpp"
#include "landing/derivatives/gradient.hpp"
#include "landing/search/nlopt_solver.hpp"
#include "landing/search/population.hpp"
#include "landing/search/scouts.hpp"
#include "landing/search/solvers.hpp"

namespace ukemi::landing {

namespace {

/// The largest local maxima of a landing, and their gradients with respect to numbers(play) (motion_space.hpp).
struct Peaks {
  std::vector<std::pair<double, Eigen::Matrix<double, kDrivenNumbers, 1>>> largest;
  integrate::Counters work;
};

/// `count`: how many maxima; `last`: index of the last number of the play that varies, fewer derivatives cost less.
Peaks peaks_of(const Scene& scene, const DrivenMotion& play, const SimulateOptions& options, int count, int last) {
  Peaks out;
  const auto unpack = [&](const auto& found) {
    out.work = found.work;
    for (const auto& p : found.peaks) {
      Eigen::Matrix<double, kDrivenNumbers, 1> d = Eigen::Matrix<double, kDrivenNumbers, 1>::Zero();
      const int motion = std::min(int(p.d.size()), kMotionNumbers);
      d.head(motion) = p.d.head(motion);
      if (p.d.size() > kMotionNumbers) d.template tail<kConstants>() = p.d.template tail<kConstants>();
      out.largest.emplace_back(p.value, d);
    }
  };
  if (last < kQuinticParameters)
    unpack(quintic_peaks(scene, play.sea, play.motion, options, count));
  else if (last < kMotionNumbers)
    unpack(motion_peaks(scene, play.sea, play.motion, options, count));
  else
    unpack(all_gradients(scene, play.sea, play.motion, options, count));
  return out;
}

/// The play of a point of the unit cube, and its Jacobian.
struct Linearised {
  DrivenMotion play;
  Eigen::MatrixXd jacobian;  ///< d numbers(play) / d u
  int last;                  ///< index of the last number that depends on u

  Linearised(const MotionSpace& space, const Coordinates& u)
      : play(space.play(space.values(u))), last(kDrivenNumbers - 1) {
    jacobian = space.jacobian(space.values(u));
    for (int k = 0; k < space.dimension(); ++k) {
      const Variable& v = space.variables()[std::size_t(k)];
      jacobian.col(k) *= v.upper - v.lower;
    }
    while (last > 0 && jacobian.row(last).isZero(0)) --last;
  }
};

void minimize_from(Search& search, int count, const decltype(EpigraphProblem::peaks)& peaks, const Candidate& start) {
  constexpr double kConverged = 1e-7;
  const auto n = std::size_t(search.dimension());
  minimize_epigraph({count,
                     peaks,
                     std::vector<double>(n, 0),
                     std::vector<double>(n, 1),
                     {start.u.begin(), start.u.end()},
                     start.value},
                    kConverged);
}

/// Derivatives of a measure with respect to the peak of each drop.
std::vector<double> measure_weights(const Measure& measure, const std::vector<double>& peaks) {
  const std::size_t n = peaks.size();
  std::vector<double> out(n, 1.0 / double(n));
  if (measure.kind == Measure::Kind::kMean) return out;
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return peaks[a] > peaks[b]; });
  std::fill(out.begin(), out.end(), 0.0);
  const double tail = (1 - measure.level) * double(n);
  if (measure.kind == Measure::Kind::kCvar) {
    for (std::size_t i = 0; i < n && double(i) < tail; ++i) out[order[i]] = std::min(1.0, tail - double(i)) / tail;
  } else {
    out[order[measure.kind == Measure::Kind::kWorst ? 0 : std::min(n - 1, std::size_t(tail))]] = 1;
  }
  return out;
}

/// Under scatter: minimises the measure over some of the drops, a smooth function (sample average approximation) whose
/// gradient is a weighted sum over the drops. Each minimum is evaluated over all drops.
void sample_average(Search& search) {
  constexpr std::size_t kDrops = 32;
  const Objective& objective = search.objective();
  const Robust& robust = *objective.options().robust;
  const auto drops = std::span(robust.drops).first(std::min(kDrops, robust.drops.size()));
  const int n = search.dimension();
  Candidate best;
  const auto average = [&](const double* u, double* a, double* gradient) {
    Candidate p = search.centre();
    std::copy_n(u, n, p.u.begin());
    search.evaluate({&p, 1}, {Goal::kRobust, drops.size()});
    if (p < best) best = p;
    const Linearised point(objective.space(), p.u);
    std::vector<double> values(drops.size(), robust.penalty);
    std::vector<Eigen::VectorXd> gradients(drops.size(), Eigen::VectorXd::Zero(n));
    std::vector<integrate::Counters> work(drops.size());
    parallel_for(int(drops.size()), objective.options().threads, [&](int k) {
      const auto i = std::size_t(k);
      const Peaks found = peaks_of(drops[i].scene, drops[i].played(objective.space(), point.play),
                                   {.accuracy = objective.accuracy(), .over = objective.over()}, 1, point.last);
      work[i] = found.work;
      if (found.largest.empty() || !found.largest[0].second.allFinite()) return;
      values[i] = found.largest[0].first, gradients[i] = point.jacobian.transpose() * found.largest[0].second;
    });
    for (const integrate::Counters& w : work) search.add_work(w);
    const std::vector<double> weights = measure_weights(robust.measure, values);
    Eigen::Map<Eigen::VectorXd> sum(gradient, n);
    sum.setZero();
    for (std::size_t i = 0; i < weights.size(); ++i) sum += weights[i] * gradients[i];
    *a = robust.measure.of(values);
    return !search.over();
  };
  for (std::uint64_t restart = 0; !search.over(); ++restart) {
    Random random(search.seed, restart);
    Candidate start = restart == 0 ? search.centre() : random_point(random, n);
    search.evaluate({&start, 1}, {Goal::kRobust, drops.size()});
    best = start;
    minimize_from(search, 1, average, start);
    best.bound = kNoMotion;
    search.evaluate({&best, 1});
  }
}

/// Repeats: scouts, then a descent from each of the best that lie apart. Most uniform starts are at cliffs.
void descend_from_scouts(Search& search, const std::function<void(const Candidate&)>& descend) {
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
      descend(start);
    }
  }
}

}  // namespace

void sequential_quadratic(Search& search) {
  if (search.objective().options().goal == Goal::kRobust) return sample_average(search);
  const Objective& objective = search.objective();
  const MotionSpace& space = objective.space();
  const bool tolerant = objective.options().goal == Goal::kTolerant;
  const int landings = tolerant ? kExecutionPoints : 1, per_landing = tolerant ? 2 : 6, count = landings * per_landing;
  const int n = space.dimension();
  // Padded to a fixed number of constraints; those beyond the maxima found, 0 <= s, always hold.
  const auto peaks = [&](const double* u, double* a, double* gradient) {
    Candidate p = search.centre();
    std::copy_n(u, n, p.u.begin());
    search.evaluate({&p, 1});
    std::fill(a, a + count, 0.0);
    std::fill(gradient, gradient + n * count, 0.0);
    const Linearised point(space, p.u);
    for (int k = 0; k < landings && !search.over(); ++k) {
      const DrivenMotion play = space.execution_point(point.play, objective.scene().execution, k);
      const SimulateOptions options{.accuracy = objective.accuracy(), .over = objective.over()};
      const Peaks found = peaks_of(objective.scene(), play, options, per_landing, point.last);
      search.add_work(found.work);
      for (std::size_t i = 0; i < found.largest.size(); ++i) {
        const auto row = std::size_t(k * per_landing) + i;
        const auto& [value, d] = found.largest[i];
        if (!std::isfinite(value) || !d.allFinite()) continue;
        a[row] = value;
        Eigen::Map<Eigen::VectorXd>(gradient + std::size_t(n) * row, n) = point.jacobian.transpose() * d;
      }
    }
    return !search.over();
  };
  const auto descend = [&](const Candidate& start) { minimize_from(search, count, peaks, start); };
  if (n > kPaperVariables) return descend_from_scouts(search, descend);
  for (std::uint64_t restart = 0; !search.over(); ++restart) {
    Random random(search.seed, restart);
    Candidate start = restart == 0 ? search.centre() : random_point(random, n);
    search.evaluate({&start, 1});
    descend(start);
  }
}

}  // namespace ukemi::landing

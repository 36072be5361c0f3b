// The paper's SQP on a form that it can differentiate: min s subject to a_k(x) <= s over the largest local maxima a_k
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

/// The largest local maxima of a play, and their gradients by its numbers (landing/model/motion_space.hpp).
struct Peaks {
  std::vector<std::pair<double, Eigen::Matrix<double, kPlayNumbers, 1>>> largest;
  integrate::Counters work;
};

/// `last`: the last of the play's numbers that anything depends on; fewer derivatives take less time.
Peaks peaks_of(const Scene& scene, const DrivenMotion& play, const SimulateOptions& options, int most, int last) {
  Peaks out;
  const auto unpack = [&](const auto& found) {
    out.work = found.work;
    for (const auto& p : found.peaks) {
      Eigen::Matrix<double, kPlayNumbers, 1> d = Eigen::Matrix<double, kPlayNumbers, 1>::Zero();
      const int motion = std::min(int(p.d.size()), kMotionNumbers);
      d.head(motion) = p.d.head(motion);
      if (p.d.size() > kMotionNumbers) d.template tail<kConstants>() = p.d.template tail<kConstants>();
      out.largest.emplace_back(p.value, d);
    }
  };
  if (last < kQuinticParameters)
    unpack(quintic_peaks(scene, play.sea, play.motion, options, most));
  else if (last < kMotionNumbers)
    unpack(motion_peaks(scene, play.sea, play.motion, options, most));
  else
    unpack(all_gradients(scene, play.sea, play.motion, options, most));
  return out;
}

/// What a point of the unit cube stands for, and how its play's numbers change with the point.
struct Place {
  DrivenMotion play;
  Eigen::MatrixXd slope;  ///< d numbers(play) / d u
  int last;               ///< of the numbers that anything depends on

  Place(const MotionSpace& space, const Coordinates& u) : play(space.play(space.values(u))), last(kPlayNumbers - 1) {
    slope = space.jacobian(space.values(u));
    for (int k = 0; k < space.dimension(); ++k) {
      const Variable& v = space.variables()[std::size_t(k)];
      slope.col(k) *= v.upper - v.lower;
    }
    while (last > 0 && slope.row(last).isZero(0)) --last;
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

/// The part of each drop in the gradient of a measure: that of a peak among those that it is made of.
std::vector<double> parts_of(const Measure& measure, const std::vector<double>& peaks) {
  const std::size_t n = peaks.size();
  std::vector<double> out(n, 1.0 / double(n));
  if (measure.kind == Measure::Kind::kMean) return out;
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return peaks[a] > peaks[b]; });
  std::fill(out.begin(), out.end(), 0.0);
  const double worse = (1 - measure.level) * double(n);
  if (measure.kind == Measure::Kind::kCvar) {
    for (std::size_t i = 0; i < n && double(i) < worse; ++i) out[order[i]] = std::min(1.0, worse - double(i)) / worse;
  } else {
    out[order[measure.kind == Measure::Kind::kWorst ? 0 : std::min(n - 1, std::size_t(worse))]] = 1;
  }
  return out;
}

/// Under scatter: the measure over a part of the drops is a smooth function (sample average approximation), its
/// gradient made of those of each drop's peak. Each minimum is judged over all drops.
void sample_average(Search& search) {
  constexpr std::size_t kDrops = 32;
  const Objective& objective = search.objective();
  const Robust& robust = *objective.options().robust;
  const auto drops = std::span(robust.drops).first(std::min(kDrops, robust.drops.size()));
  const int n = search.dimension();
  Candidate best;
  const auto average = [&](const double* u, double* a, double* gradient) {
    Candidate p = search.nothing();
    std::copy_n(u, n, p.u.begin());
    search.evaluate({&p, 1}, {Goal::kRobust, drops.size()});
    if (p < best) best = p;
    const Place place(objective.space(), p.u);
    std::vector<double> values(drops.size(), robust.penalty);
    std::vector<Eigen::VectorXd> slopes(drops.size(), Eigen::VectorXd::Zero(n));
    std::vector<integrate::Counters> work(drops.size());
    parallel_for(int(drops.size()), objective.options().threads, [&](int k) {
      const auto i = std::size_t(k);
      const Peaks found = peaks_of(drops[i].scene, drops[i].played(objective.space(), place.play),
                                   {.accuracy = objective.accuracy(), .over = objective.over()}, 1, place.last);
      work[i] = found.work;
      if (found.largest.empty() || !found.largest[0].second.allFinite()) return;
      values[i] = found.largest[0].first, slopes[i] = place.slope.transpose() * found.largest[0].second;
    });
    for (const integrate::Counters& w : work) search.spend(w);
    const std::vector<double> parts = parts_of(robust.measure, values);
    Eigen::Map<Eigen::VectorXd> slope(gradient, n);
    slope.setZero();
    for (std::size_t i = 0; i < parts.size(); ++i) slope += parts[i] * slopes[i];
    *a = robust.measure.of(values);
    return !search.over();
  };
  for (std::uint64_t restart = 0; !search.over(); ++restart) {
    Random random(search.seed, restart);
    Candidate start = restart == 0 ? search.nothing() : random_point(random, n);
    search.evaluate({&start, 1}, {Goal::kRobust, drops.size()});
    best = start;
    minimize_from(search, 1, average, start);
    best.bound = kNoMotion;
    search.evaluate({&best, 1});
  }
}

/// Races in lanes, from anywhere and beside the best so far, and a descent from each of their best that lie apart,
/// again and again: with many variables starts from anywhere are on cliffs.
void descend_from_races(Search& search, const std::function<void(const Candidate&)>& descend) {
  constexpr long kMotions = 1'500;
  constexpr std::size_t kStarts = 16, kDescents = 6;
  constexpr double kApart = 0.1;  // parts of the box
  constexpr Scouting kRace{.anywhere = 0.5, .nearest = -2, .farthest = -0.6, .plain = 0.1};
  Random random(search.seed);
  Archive starts(kStarts, kApart);
  std::vector<Candidate> batch;
  for (; !search.over(); starts.clear()) {
    for (long n = 0; n < kMotions && !search.over(); n += kBatch)
      scout(search, random, kRace, Goal::kPeak, starts, batch);
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
  const int boxes = tolerant ? kExecutionPoints : 1, each = tolerant ? 2 : 6, count = boxes * each;
  const int n = space.dimension();
  // Padded to a fixed number: where there are fewer, a constraint that is always kept.
  const auto peaks = [&](const double* u, double* a, double* gradient) {
    Candidate p = search.nothing();
    std::copy_n(u, n, p.u.begin());
    search.evaluate({&p, 1});
    std::fill(a, a + count, 0.0);
    std::fill(gradient, gradient + n * count, 0.0);
    const Place place(space, p.u);
    for (int k = 0; k < boxes && !search.over(); ++k) {
      const DrivenMotion at = space.execution_point(place.play, objective.scene().execution, k);
      const Peaks found = peaks_of(objective.scene(), at, {.accuracy = objective.accuracy(), .over = objective.over()},
                                   each, place.last);
      search.spend(found.work);
      for (std::size_t i = 0; i < found.largest.size(); ++i) {
        const auto row = std::size_t(k * each) + i;
        const auto& [value, d] = found.largest[i];
        if (!std::isfinite(value) || !d.allFinite()) continue;
        a[row] = value;
        Eigen::Map<Eigen::VectorXd>(gradient + std::size_t(n) * row, n) = place.slope.transpose() * d;
      }
    }
    return !search.over();
  };
  const auto descend = [&](const Candidate& start) { minimize_from(search, count, peaks, start); };
  if (n > kPaperVariables) return descend_from_races(search, descend);
  for (std::uint64_t restart = 0; !search.over(); ++restart) {
    Random random(search.seed, restart);
    Candidate start = restart == 0 ? search.nothing() : random_point(random, n);
    search.evaluate({&start, 1});
    descend(start);
  }
}

}  // namespace ukemi::landing

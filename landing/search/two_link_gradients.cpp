// The largest peaks of a landing of the paper's robot, with their derivatives by the coordinates of the box.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/parallel.hpp"
#include "landing/derivatives/gradient.hpp"
#include "landing/search/two_link_objective.hpp"

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

constexpr int kOfOne = 6, kOfEach = 2;  // peaks of a single landing; of each of an execution box

}  // namespace

int TwoLinkObjective::gradient_rows(Fidelity fidelity) const {
  if (fidelity.goal == Goal::kRobust) return 1;
  return fidelity.goal == Goal::kTolerant ? kExecutionPoints * kOfEach : kOfOne;
}

void TwoLinkObjective::linearise(const Coordinates& u, Fidelity fidelity, std::span<double> peaks,
                                 std::span<double> gradient) {
  const Linearised point(space_, u);
  const SimulateOptions options{.accuracy = accuracy(), .over = over()};
  const auto n = std::size_t(dimension());
  std::fill(peaks.begin(), peaks.end(), 0.0), std::fill(gradient.begin(), gradient.end(), 0.0);
  if (fidelity.goal == Goal::kRobust) {  // a weighted sum over the drops
    const auto drops = std::span(robust_->drops).first(std::min(fidelity.drops, robust_->drops.size()));
    std::vector<double> values(drops.size(), robust_->penalty);
    std::vector<Eigen::VectorXd> gradients(drops.size(), Eigen::VectorXd::Zero(long(n)));
    std::vector<integrate::Counters> work(drops.size());
    parallel_for(int(drops.size()), threads(), [&](int k) {
      const auto i = std::size_t(k);
      const Peaks found = peaks_of(drops[i].scene, drops[i].played(space_, point.play), options, 1, point.last);
      work[i] = found.work;
      if (found.largest.empty() || !found.largest[0].second.allFinite()) return;
      values[i] = found.largest[0].first, gradients[i] = point.jacobian.transpose() * found.largest[0].second;
    });
    for (const integrate::Counters& w : work) work_ += work_of(w);
    const std::vector<double> weights = measure_weights(robust_->measure, values);
    Eigen::Map<Eigen::VectorXd> sum(gradient.data(), long(n));
    for (std::size_t i = 0; i < weights.size(); ++i) sum += weights[i] * gradients[i];
    peaks[0] = robust_->measure.of(values);
    return;
  }
  const bool tolerant = fidelity.goal == Goal::kTolerant;
  const int landings = tolerant ? kExecutionPoints : 1, per_landing = tolerant ? kOfEach : kOfOne;
  for (int k = 0; k < landings && !interrupted(); ++k) {
    const DrivenMotion play = space_.execution_point(point.play, scene_.execution, k);
    const Peaks found = peaks_of(scene_, play, options, per_landing, point.last);
    work_ += work_of(found.work);
    for (std::size_t i = 0; i < found.largest.size(); ++i) {
      const auto row = std::size_t(k * per_landing) + i;
      const auto& [value, d] = found.largest[i];
      if (!std::isfinite(value) || !d.allFinite()) continue;
      peaks[row] = value;
      Eigen::Map<Eigen::VectorXd>(gradient.data() + n * row, long(n)) = point.jacobian.transpose() * d;
    }
  }
}

}  // namespace ukemi::landing

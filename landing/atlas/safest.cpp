#include <algorithm>
#include <numeric>

#include "landing/atlas/atlas.hpp"

namespace ukemi::landing {

namespace {

/// Plays motions over drops, in an order in which the drops that ended a motion come first.
class Trials {
 public:
  Trials(const AtlasRobot& robot, const AtlasGrid& grid, std::span<const AtlasCell> cells, int threads,
         const Monitor& monitor)
      : grid_(grid),
        stopped_([&monitor] { return monitor.stopped(); }),
        trial_(robot.trial(threads, stopped_)),
        order_(cells.size()) {
    const auto hardness = [&](std::size_t i) { return cells[i].planned() ? cells[i].peak : kNoMotion; };
    std::iota(order_.begin(), order_.end(), 0);
    std::stable_sort(order_.begin(), order_.end(),
                     [&](std::size_t a, std::size_t b) { return hardness(a) > hardness(b); });
  }

  /// The worst peak of a drop's motion, or the first one above `bound`, whose drop comes first from then on.
  double worst(std::size_t drop, const MotionValues& values, double bound) {
    trial_->set(grid_.drop(drop), values);
    double worst = 0;
    for (std::size_t from = 0, part = kFirst; from < order_.size(); from += part, part = kPart) {
      part = std::min(part, order_.size() - from);
      drops_.clear(), peaks_.resize(part);
      for (std::size_t k = 0; k < part; ++k) drops_.push_back(grid_.drop(order_[from + k]));
      trial_->play(drops_, bound, peaks_);
      for (std::size_t k = 0; k < part; ++k) {
        worst = std::max(worst, peaks_[k]);
        if (!(worst > bound)) continue;
        std::rotate(order_.begin(), order_.begin() + long(from + k), order_.begin() + long(from + k) + 1);
        return worst;
      }
    }
    return worst;
  }

 private:
  static constexpr std::size_t kFirst = 8, kPart = 64;
  const AtlasGrid& grid_;
  const std::function<bool()> stopped_;
  std::unique_ptr<AtlasTrial> trial_;
  std::vector<std::size_t> order_;
  std::vector<Drop> drops_;
  std::vector<double> peaks_;
};

}  // namespace

SafestMotion safest_motion(const AtlasRobot& robot, const AtlasGrid& grid, std::span<const AtlasCell> cells,
                           int threads, const Monitor& monitor) {
  grid.check_cells(cells.size());
  const int dimension = int(robot.variables().size());
  Trials trials(robot, grid, cells, threads, monitor);
  SafestMotion best{.worst = kNoMotion};
  for (std::size_t i = 0; i < cells.size() && !monitor.stopped(); ++i) {
    monitor.progress(long(i), long(cells.size()));
    if (!cells[i].planned()) continue;
    const double worst = trials.worst(i, cells[i].coordinates(dimension), best.worst);
    if (worst < best.worst) best = {i, worst};
  }
  return monitor.stopped() ? SafestMotion{} : best;
}

}  // namespace ukemi::landing

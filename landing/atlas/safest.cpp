#include <algorithm>
#include <cmath>
#include <numeric>

#include "landing/atlas/atlas.hpp"
#include "landing/atlas/atlas_file.hpp"
#include "landing/lanes/batch.hpp"

namespace ukemi::landing {

namespace {

/// Motions played over drops, which are kept in the order in which they are played.
class Trials {
 public:
  Trials(const Scene& scene, const SeaParameters<double>& sea, const AtlasGrid& grid, std::span<const AtlasCell> cells,
         int threads, const Monitor& monitor)
      : sea_(sea),
        grid_(grid),
        threads_(threads),
        stopped_([&monitor] { return monitor.stopped(); }),
        order_(cells.size()),
        scenes_(kPart, scene) {
    const auto hardness = [&](std::size_t i) { return cells[i].planned() ? cells[i].peak : kNoMotion; };
    std::iota(order_.begin(), order_.end(), 0);
    std::stable_sort(order_.begin(), order_.end(),
                     [&](std::size_t a, std::size_t b) { return hardness(a) > hardness(b); });
    if (scene.joint) limits_.joint = *scene.joint;
  }

  /// The worst peak, or what is above `bound` as soon as a drop is; that drop comes first from then on.
  double worst(const Play& play, double bound) {
    constexpr double kAccuracy = 1e-5;
    double worst = 0;
    for (std::size_t from = 0, part = kFirst; from < order_.size(); from += part, part = kPart) {
      part = std::min(part, order_.size() - from);
      cases_.clear();
      for (std::size_t k = 0; k < part; ++k) {
        scenes_[k].drop = grid_.drop(order_[from + k]);
        cases_.push_back({&scenes_[k], &play.sea, play.motion, bound});
      }
      peaks_.resize(part);
      batch_peaks(cases_, peaks_, {.accuracy = kAccuracy, .limits = limits_, .over = &stopped_}, threads_);
      for (std::size_t k = 0; k < part; ++k) {
        const LandingPeak& p = peaks_[k];
        worst = std::max(worst, no_landing(p.end) || p.end == End::kStopped ? kNoMotion : p.peak);
        if (!(worst > bound)) continue;
        std::rotate(order_.begin(), order_.begin() + long(from + k), order_.begin() + long(from + k) + 1);
        return worst;
      }
    }
    return worst;
  }

 private:
  static constexpr std::size_t kFirst = 8, kPart = 64;
  const SeaParameters<double>& sea_;
  const AtlasGrid& grid_;
  int threads_;
  const std::function<bool()> stopped_;
  Limits limits_;
  std::vector<std::size_t> order_;
  std::vector<Scene> scenes_;
  std::vector<BatchCase> cases_;
  std::vector<LandingPeak> peaks_;
};

}  // namespace

SafestMotion safest_motion(const Scene& scene, const SeaParameters<double>& sea, const AtlasGrid& grid,
                           std::span<const AtlasCell> cells, int threads, const Monitor& monitor) {
  grid.check_cells(cells.size());
  Trials trials(scene, sea, grid, cells, threads, monitor);
  SafestMotion best{.worst = kNoMotion};
  Scene there = scene;
  for (std::size_t i = 0; i < cells.size() && !monitor.stopped(); ++i) {
    monitor.progress(long(i), long(cells.size()));
    if (!cells[i].planned()) continue;
    there.drop = grid.drop(i);
    const ReferenceSpace space(there, sea);
    const double worst = trials.worst(space.play(cells[i].coordinates(space.dimension())), best.worst);
    if (worst < best.worst) best = {i, worst};
  }
  return monitor.stopped() ? SafestMotion{} : best;
}

}  // namespace ukemi::landing

#include "landing/plan/body_goal.hpp"

#include <algorithm>

#include "common/parallel.hpp"
#include "landing/derivatives/body_gradient.hpp"
#include "landing/search/nlopt_solver.hpp"
#include "landing/search/population.hpp"

namespace ukemi::landing {

double BodyGoal::value(const BodyMotion& motion, double accuracy, double bound, const std::function<bool()>* over,
                       long& played) const {
  const bool largest = worst();
  std::vector<double> peaks(counted, 0.0), copy;
  played = 0;
  long broken = 0;
  for (std::size_t k = 0; k < drops.size(); ++k) {
    SimulateOptions options{.accuracy = accuracy, .over = over};
    const bool counts = k < counted;
    if (largest && counts) options.abandon_above = bound;
    const BodyLanding l = peak_acceleration(drops[k].scene, drops[k].played(motion), options);
    ++played;
    if (no_landing(l.end) || l.end == End::kStopped) return kNoMotion;
    if (l.broken && ++broken > may_break()) return kNoMotion;
    if (!counts) continue;
    peaks[k] = l.peak;
    if (!(bound < kNoMotion) && k + 1 < counted) continue;
    copy = peaks;
    if (const double v = measure.of(copy); v > bound) return v;
  }
  return measure.of(peaks);
}

namespace {

BodyScene strict(BodyScene scene) {
  scene.limits.broken = BodyLimits::Broken::kEnds;
  return scene;
}
}  // namespace

BodyGoal own_drop(const BodyScene& scene) {
  return {{Measure::Kind::kWorst}, {{strict(scene), std::vector<BodyDrop::Joint>(scene.robot.joints.size())}}};
}
BodyGoal execution_box(const BodyScene& scene, bool counts) {
  BodyGoal out{{Measure::Kind::kWorst}, execution_drops(strict(scene))};
  if (!counts) out.counted = 1;
  return out;
}

void descend_by_gradient(const BodyGoal& goal, const BodySpace& space, const Coordinates& start, double value,
                         int threads, const std::function<bool(const Coordinates&)>& play) {
  constexpr double kConverged = 1e-7;
  const int each = goal.single() ? 6 : 2, n = space.dimension();
  const std::vector<BodyParameter> parameters = space.parameters();
  const auto peaks = [&](const double* x, double* a, double* slopes) {
    const Coordinates u = Eigen::Map<const Eigen::VectorXd>(x, n);
    if (!play(u)) return false;
    const BodyMotion motion = space.motion(u);
    // Padded to a fixed number: where there are fewer, a constraint that is always kept.
    std::fill_n(a, std::size_t(each) * goal.counted, 0.0);
    std::fill_n(slopes, std::size_t(each * n) * goal.counted, 0.0);
    parallel_for(int(goal.counted), threads, [&](int drop_index) {
      const auto k = std::size_t(drop_index);
      const BodyDrop& drop = goal.drops[k];
      const BodyGradients g =
          gradients(drop.scene, drop.played(motion), parameters, {.accuracy = kSearchAccuracy}, each);
      for (std::size_t i = 0; i < g.peaks.size(); ++i) {
        if (!g.peaks[i].d.allFinite()) continue;
        const std::size_t row = k * std::size_t(each) + i;
        a[row] = g.peaks[i].value;
        for (int j = 0; j < n; ++j) {
          const Variable& v = space.variables()[std::size_t(j)];
          slopes[row * std::size_t(n) + std::size_t(j)] = g.peaks[i].d[j] * (v.upper - v.lower);
        }
      }
    });
    return true;
  };
  minimize_epigraph({each * int(goal.counted),
                     peaks,
                     std::vector<double>(std::size_t(n), 0),
                     std::vector<double>(std::size_t(n), 1),
                     {start.begin(), start.end()},
                     value},
                    kConverged);
}

}  // namespace ukemi::landing

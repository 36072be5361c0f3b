#include "landing/judge/limit.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/checks.hpp"
#include "common/parallel.hpp"
#include "landing/run/simulate.hpp"

namespace ukemi::landing {

namespace {

/// The peak until `duration` after the first touchdown, the joint held at phi; infinite without a touchdown.
double held_peak(const Scene& scene, const SeaParameters<double>& sea, double phi, double duration) {
  const Motion hold{phi, phi, 1};
  Scene window = scene;
  window.release.reset();
  window.detection_delay = 0;
  window.t_end.reset();
  const double touchdown = first_touchdown(window, sea, hold);
  if (!std::isfinite(touchdown)) return touchdown;
  window.t_end = touchdown + duration;
  return peak_acceleration(window, sea, hold).peak;
}

/// A value and its angle.
struct Minimum {
  double phi = 0, value = std::numeric_limits<double>::infinity();
};
template <class F>
Minimum refined_minimum(double low, double high, int threads, F&& f) {
  constexpr int kPoints = 65, kRounds = 3;
  Minimum best;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<Minimum> row(kPoints);
    const double step = (high - low) / (kPoints - 1);
    parallel_for(kPoints, threads, [&](int i) {
      const double phi = low + step * i;
      row[std::size_t(i)] = {phi, f(phi)};
    });
    const Minimum at = *std::min_element(row.begin(), row.end(), [](auto& a, auto& b) { return a.value < b.value; });
    if (at.value < best.value) best = at;
    low = std::max(low, best.phi - 2 * step), high = std::min(high, best.phi + 2 * step);
  }
  return best;
}

}  // namespace

TouchdownLimit touchdown_limit(const Scene& scene, const SeaParameters<double>& sea, int threads) {
  scene.validate(), validate(sea);
  if (!scene.touches()) return {};
  double low = scene.search.phi[0], high = scene.search.phi[1];
  if (scene.joint) low = std::max(low, (*scene.joint)[0]), high = std::min(high, (*scene.joint)[1]);
  const auto over_postures = [&](double duration) {
    return refined_minimum(low, high, threads, [&](double phi) { return held_peak(scene, sea, phi, duration); });
  };
  constexpr double kJustAfter = 1e-9;  // [s]
  const Minimum jump = over_postures(kJustAfter), contact = over_postures(TouchdownLimit::kFirstContact);
  return {jump.value, jump.phi, contact.value, contact.phi, std::isfinite(jump.value)};
}

}  // namespace ukemi::landing

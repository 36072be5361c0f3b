#include "landing/judge/limit.hpp"

#include <algorithm>
#include <cmath>

#include "common/checks.hpp"
#include "landing/judge/refined_minimum.hpp"
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

}  // namespace

TouchdownLimit touchdown_limit(const Scene& scene, const SeaParameters<double>& sea, int threads) {
  scene.validate(), validate(sea);
  if (!scene.touches()) return {};
  double low = scene.search.phi[0], high = scene.search.phi[1];
  if (scene.joint) low = std::max(low, (*scene.joint)[0]), high = std::min(high, (*scene.joint)[1]);
  const auto over_postures = [&](double duration) {
    return refined_minimum(low, high, {.points = 65, .rounds = 3, .reach = 2}, threads,
                           [&](double phi) { return held_peak(scene, sea, phi, duration); });
  };
  constexpr double kJustAfter = 1e-9;  // [s]
  const PostureMinimum jump = over_postures(kJustAfter), contact = over_postures(TouchdownLimit::kFirstContact);
  return {jump.value, jump.phi, contact.value, contact.phi, std::isfinite(jump.value)};
}

}  // namespace ukemi::landing

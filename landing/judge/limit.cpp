#include "landing/judge/limit.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "common/checks.hpp"
#include "common/parallel.hpp"
#include "landing/run/simulate.hpp"

namespace ukemi::landing {

namespace {

/// The peak until `after` the first touchdown, the joint held at phi; infinite where it never comes.
double held_peak(const Scene& scene, const SeaParameters<double>& sea, double phi, double after) {
  const Motion hold{phi, phi, 1};
  Scene until = scene;
  until.release.reset();
  until.detection_delay = 0;
  until.t_end.reset();
  const double touchdown = first_touchdown(until, sea, hold);
  if (!std::isfinite(touchdown)) return touchdown;
  until.t_end = touchdown + after;
  return peak_acceleration(until, sea, hold).peak;
}

/// The angle of the smallest value.
struct Smallest {
  double phi = 0, value = std::numeric_limits<double>::infinity();
};
template <class F>
Smallest smallest(double low, double high, int threads, F&& f) {
  constexpr int kPoints = 65, kRounds = 3;
  Smallest best;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<Smallest> row(kPoints);
    const double step = (high - low) / (kPoints - 1);
    parallel_for(kPoints, threads, [&](int i) {
      const double phi = low + step * i;
      row[std::size_t(i)] = {phi, f(phi)};
    });
    const Smallest at = *std::min_element(row.begin(), row.end(), [](auto& a, auto& b) { return a.value < b.value; });
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
  const auto over_postures = [&](double after) {
    return smallest(low, high, threads, [&](double phi) { return held_peak(scene, sea, phi, after); });
  };
  constexpr double kBehind = 1e-9;  // [s]
  const Smallest jump = over_postures(kBehind), contact = over_postures(TouchdownLimit::kFirstContact);
  return {jump.value, jump.phi, contact.value, contact.phi, std::isfinite(jump.value)};
}

}  // namespace ukemi::landing

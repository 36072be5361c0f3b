// The fast path of a landing: only its peak.
#include "landing/model/release.hpp"
#include "landing/run/kernels.hpp"

namespace ukemi::landing {

LandingPeak peak_acceleration(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                              const SimulateOptions& options) {
  validate(scene, sea, motion), options.validate();
  LandingPeak out;
  if (options.method == Method::kAuto)
    dispatch<false>(scene, sea, motion, options, out, nullptr, 0);
  else
    follow_with_method(scene, sea, motion, options, out);
  return out;
}

double first_touchdown(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion) {
  validate(scene, sea, motion);
  constexpr double kNever = std::numeric_limits<double>::infinity();
  if (is_ballistic(scene.drop, motion.release_rate()) && !motion.reposition) {
    const double fall = fall_time(scene);
    return fall < flight_limit(scene, motion) ? fall : kNever;
  }
  std::vector<double> touchdowns;
  const std::function<bool()> touched = [&] { return !touchdowns.empty(); };
  (void)peak_acceleration(scene, sea, motion, {.touchdowns = &touchdowns, .over = &touched});
  return touchdowns.empty() ? kNever : touchdowns.front();
}

}  // namespace ukemi::landing

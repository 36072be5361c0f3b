#include "tools/study/landing_of_fit.hpp"

#include <cmath>
#include <limits>

#include "landing/scatter/measure.hpp"
#include "landing/scatter/scattered.hpp"

namespace ukemi::tools {

using namespace landing;

LandingOfFit landing_of_fit(const Scene& scene, const Actuator& actuator, const Motion& motion, std::uint64_t seed,
                            int threads) {
  constexpr long kSamples = 1024;
  constexpr double kAccuracy = 1e-6;
  LandingOfFit out{.scene = scene, .motion = motion};
  const DropModel model(scene, Scatter{}, actuator, {.floor = false});
  const auto peaks = [&](const std::vector<ScatteredDrop>& drops) {
    ScatteredLandings landings;
    const DrivenMotion planned{motion, actuator.sea};
    std::vector<double> all;
    for (const LandingPeak& l : landings.play({&planned, 1}, drops, {.accuracy = kAccuracy, .threads = threads}))
      all.push_back(counted(l, std::numeric_limits<double>::infinity()));
    return all;
  };
  out.peak = peaks({ScatteredDrop{.scene = scene}}).front();
  if (!model.scatters()) return out;
  std::vector<double> drawn = peaks(model.even(kSamples, seed));
  out.failed = std::erase_if(drawn, [](double peak) { return !std::isfinite(peak); });
  const Distribution d = distribution(drawn);
  out.samples = d.samples, out.mean = d.mean.value, out.worst_tenth = d.cvar90.value;
  out.deviation = d.mean.standard_error * std::sqrt(double(d.samples));
  return out;
}

}  // namespace ukemi::tools

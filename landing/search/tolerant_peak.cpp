#include "landing/search/tolerant_peak.hpp"

#include <algorithm>

#include "common/parallel.hpp"
#include "common/random.hpp"
#include "landing/lanes/batch.hpp"
#include "landing/run/work.hpp"

namespace ukemi::landing {

TolerantPeak tolerant_peak(const Scene& scene, const MotionSpace& space, const DrivenMotion& x,
                           const SimulateOptions& options, int samples, std::uint64_t seed, int threads) {
  TolerantPeak out;
  std::vector<LandingPeak> peaks(kExecutionPoints);
  const auto box = [&](int k) { return space.execution_point(x, scene.execution, k); };
  const auto play = [&](const DrivenMotion& p) { return peak_acceleration(scene, p.sea, p.motion, options); };
  parallel_for(kExecutionPoints, threads, [&](int k) { peaks[std::size_t(k)] = play(box(k)); });
  out.peak = peaks[0].peak;
  const auto count = [&](std::array<int, kPoints>& touching) {
    for (const LandingPeak& p : peaks) {
      out.failed = out.failed || no_landing(p.end);
      out.complete = out.complete && p.end != End::kStopped;
      for (int j = 0; j < kPoints; ++j) touching[std::size_t(j)] += p.contacts.touched(Point(j));
    }
  };
  count(out.touching);
  long longest = 1;
  for (int k = 0; k < kExecutionPoints; ++k) {
    const LandingPeak& p = peaks[std::size_t(k)];
    longest = std::max(longest, work_of(p.work));
    if (p.peak > out.value) out.value = p.peak, out.worst = box(k).motion;
  }
  constexpr long kInLanes = 10;  // steps in lanes cost a tenth
  if (samples * longest > kInLanes * kCheckWork) samples = int(kCheckWork / longest);
  if (!out.complete) samples = 0;
  out.samples = samples;
  if (samples == 0) return out;
  // In lanes; the worst again in the scalar path.
  std::vector<DrivenMotion> plays;
  std::vector<BatchCase> inside;
  plays.reserve(std::size_t(samples));
  for (int i = 0; i < samples; ++i) {
    Random r(seed, std::uint64_t(i));
    const double a = r.uniform(-1, 1), b = r.uniform(-1, 1), c = r.uniform(-1, 1);
    plays.push_back(space.inexact(x, scene.execution, {a, b, c}));
    inside.push_back({&scene, &plays.back().sea, plays.back().motion});
  }
  peaks.resize(inside.size());
  batch_peaks(inside, peaks, {.accuracy = 1e-6, .over = options.over}, threads);
  count(out.samples_touching);
  const auto worst = std::max_element(peaks.begin(), peaks.end(),
                                      [](const LandingPeak& a, const LandingPeak& b) { return a.peak < b.peak; });
  out.sampled = play(plays[std::size_t(worst - peaks.begin())]).peak;
  return out;
}

TolerantPeak tolerant_peak(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                           const SimulateOptions& options, int samples, std::uint64_t seed, int threads) {
  return tolerant_peak(scene, ReferenceSpace(scene, sea), {motion, sea}, options, samples, seed, threads);
}

}  // namespace ukemi::landing

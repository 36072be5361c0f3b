#include "landing/search/robust.hpp"

#include <algorithm>
#include <cmath>

#include "common/parallel.hpp"
#include "common/random.hpp"
#include "landing/lanes/batch.hpp"
#include "landing/run/work.hpp"

namespace ukemi::landing {

namespace {
constexpr double kShortest = 1e-4;  // a box wider than the duration itself stops here [s]

Motion moved(const Motion& m, const ExecutionTolerance& tol, double i, double j, double k) {
  return {m.phi_i + i * tol.phi, m.phi_f + j * tol.phi, std::max(kShortest, m.duration + k * tol.duration)};
}
}  // namespace

Motion execution_point(const Motion& m, const ExecutionTolerance& tol, int k) {
  if (k == 0) return m;
  if (k <= 6) {
    const double s = k % 2 ? -1 : 1;
    const int axis = (k - 1) / 2;
    return moved(m, tol, axis == 0 ? s : 0, axis == 1 ? s : 0, axis == 2 ? s : 0);
  }
  const int c = k - 7;
  return moved(m, tol, c & 4 ? 1 : -1, c & 2 ? 1 : -1, c & 1 ? 1 : -1);
}

TolerantPeak tolerant_peak(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                           const SimulateOptions& options, int samples, std::uint64_t seed, int threads) {
  TolerantPeak out;
  std::vector<LandingPeak> peaks(kExecutionPoints);
  const auto play = [&](const Motion& m) { return peak_acceleration(scene, sea, m, options); };
  parallel_for(kExecutionPoints, threads,
               [&](int k) { peaks[std::size_t(k)] = play(execution_point(motion, scene.execution, k)); });
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
    if (p.peak > out.value) out.value = p.peak, out.worst = execution_point(motion, scene.execution, k);
  }
  constexpr long kInLanes = 10;  // a lane's step takes a tenth
  if (samples * longest > kInLanes * kCheckWork) samples = int(kCheckWork / longest);
  if (!out.complete) samples = 0;
  out.samples = samples;
  if (samples == 0) return out;
  // Many, so in lanes; the scalar path says what the worst of them is.
  std::vector<BatchCase> inside;
  for (int i = 0; i < samples; ++i) {
    Random r(seed, std::uint64_t(i));
    const double a = r.uniform(-1, 1), b = r.uniform(-1, 1), c = r.uniform(-1, 1);
    inside.push_back({&scene, &sea, moved(motion, scene.execution, a, b, c)});
  }
  peaks.resize(inside.size());
  batch_peaks(inside, peaks, {.accuracy = 1e-6, .over = options.over}, threads);
  count(out.samples_touching);
  const auto worst = std::max_element(peaks.begin(), peaks.end(),
                                      [](const LandingPeak& a, const LandingPeak& b) { return a.peak < b.peak; });
  out.sampled = play(inside[std::size_t(worst - peaks.begin())].motion).peak;
  return out;
}

}  // namespace ukemi::landing

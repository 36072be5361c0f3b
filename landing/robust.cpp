#include "landing/robust.hpp"

#include <algorithm>
#include <cmath>

#include "common/parallel.hpp"
#include "common/random.hpp"

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
  std::vector<Motion> points;
  for (int k = 0; k < kExecutionPoints; ++k) points.push_back(execution_point(motion, scene.execution, k));
  for (int i = 0; i < samples; ++i) {
    Random r(seed, std::uint64_t(i));
    const double a = r.uniform(-1, 1), b = r.uniform(-1, 1), c = r.uniform(-1, 1);
    points.push_back(moved(motion, scene.execution, a, b, c));
  }
  std::vector<LandingPeak> peaks(points.size());
  parallel_for(int(points.size()), threads,
               [&](int i) { peaks[std::size_t(i)] = peak_acceleration(scene, sea, points[std::size_t(i)], options); });
  TolerantPeak out;
  out.peak = peaks[0].peak;
  out.samples = samples;
  for (std::size_t i = 0; i < points.size(); ++i) {
    out.failed = out.failed || peaks[i].end == End::kFailed;
    if (i >= kExecutionPoints)
      out.sampled = std::max(out.sampled, peaks[i].peak);
    else if (peaks[i].peak > out.value)
      out.value = peaks[i].peak, out.worst = points[i];
  }
  return out;
}

}  // namespace ukemi::landing

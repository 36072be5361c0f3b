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

std::vector<Motion> execution_box(const Motion& m, const ExecutionTolerance& tol) {
  std::vector<Motion> box{m};
  for (const int s : {-1, 1}) {
    box.push_back(moved(m, tol, s, 0, 0));
    box.push_back(moved(m, tol, 0, s, 0));
    box.push_back(moved(m, tol, 0, 0, s));
  }
  for (const int i : {-1, 1})
    for (const int j : {-1, 1})
      for (const int k : {-1, 1}) box.push_back(moved(m, tol, i, j, k));
  return box;
}

TolerantPeak tolerant_peak(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                           const SimulateOptions& options, int samples, std::uint64_t seed, int threads) {
  std::vector<Motion> points = execution_box(motion, scene.execution);
  const std::size_t box = points.size();
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
    if (i >= box)
      out.sampled = std::max(out.sampled, peaks[i].peak);
    else if (peaks[i].peak > out.value)
      out.value = peaks[i].peak, out.worst = points[i];
  }
  return out;
}

}  // namespace ukemi::landing

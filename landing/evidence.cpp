#include "landing/evidence.hpp"

#include <algorithm>
#include <cmath>

#include "landing/batch.hpp"

namespace ukemi::landing {

namespace {

constexpr double kDegree = 0.017453292519943295;

double& variable(Motion& m, int k) { return k == 0 ? m.phi_i : k == 1 ? m.phi_f : m.duration; }

std::vector<double> peaks_of(const Scene& scene, const SeaParameters<double>& sea, const std::vector<Motion>& motions,
                             double accuracy, int threads) {
  std::vector<BatchCase> cases;
  for (const Motion& m : motions) cases.push_back({&scene, &sea, m});
  std::vector<LandingPeak> peaks(cases.size());
  batch_peaks(cases, peaks, {.accuracy = accuracy}, threads);
  std::vector<double> out;
  for (const LandingPeak& p : peaks)
    out.push_back(no_landing(p.end) ? std::numeric_limits<double>::infinity() : p.peak);
  return out;
}

double worst_of(const Scene& scene, const SeaParameters<double>& sea, const std::vector<Motion>& motions,
                double accuracy, int threads) {
  const auto peaks = peaks_of(scene, sea, motions, accuracy, threads);
  return *std::max_element(peaks.begin(), peaks.end());
}

/// How far one variable may move one way.
double width(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion, int k, double direction,
             double limit, double accuracy, int threads) {
  constexpr int kCoarse = 40, kFine = 24;
  const auto& range = k == 2 ? scene.search.duration : scene.search.phi;
  Motion at = motion;
  const double room = direction > 0 ? range[1] - variable(at, k) : variable(at, k) - range[0];
  if (!(room > 0)) return 0;
  double good = 0, bad = room;
  for (const int points : {kCoarse, kFine}) {
    std::vector<Motion> motions;
    std::vector<double> offsets;
    for (int i = 1; i <= points; ++i) {
      const double share = double(i) / points;
      offsets.push_back(points == kCoarse ? room * std::pow(10.0, 7 * (share - 1)) : good + share * (bad - good));
      Motion m = motion;
      variable(m, k) += direction * offsets.back();
      motions.push_back(m);
    }
    const auto peaks = peaks_of(scene, sea, motions, accuracy, threads);
    const auto first = std::find_if(peaks.begin(), peaks.end(), [&](double p) { return p > limit; }) - peaks.begin();
    if (first == points) return offsets.back();
    bad = offsets[std::size_t(first)];
    if (first > 0) good = offsets[std::size_t(first) - 1];
  }
  return good;
}

}  // namespace

Evidence evidence(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion, double accuracy,
                  int tolerance_samples, std::uint64_t seed, int threads) {
  Evidence out;
  out.peak = peak_acceleration(scene, sea, motion, {.accuracy = accuracy}).peak;
  const double limit = out.peak * (1 + Evidence::kRise);
  for (int k = 0; k < 3; ++k)
    for (const int side : {0, 1})
      out.width[std::size_t(k)][std::size_t(side)] =
          width(scene, sea, motion, k, side ? 1 : -1, limit, accuracy, threads);
  std::vector<Motion> turned, timed;
  for (const double i : {-1.0, 0.0, 1.0})
    for (const double j : {-1.0, 0.0, 1.0})
      turned.push_back({motion.phi_i + i * kDegree, motion.phi_f + j * kDegree, motion.duration});
  for (const double s : {-0.01, 0.01})
    timed.push_back({motion.phi_i, motion.phi_f, std::max(1e-4, motion.duration + s)});
  out.one_degree = worst_of(scene, sea, turned, accuracy, threads);
  out.ten_milliseconds = worst_of(scene, sea, timed, accuracy, threads);
  for (const double s : {-0.01, 0.01}) {
    Scene other = scene;
    other.drop.height = std::max(0.0, scene.drop.height + s);
    out.one_centimetre = std::max(out.one_centimetre, worst_of(other, sea, {motion}, accuracy, threads));
  }
  out.tolerant = tolerant_peak(scene, sea, motion, {.accuracy = accuracy}, tolerance_samples, seed, threads);
  return out;
}

}  // namespace ukemi::landing

#include "landing/judge/evidence.hpp"

#include <algorithm>
#include <cmath>

#include "common/checks.hpp"
#include "common/degrees.hpp"
#include "common/error.hpp"
#include "landing/lanes/batch.hpp"

namespace ukemi::landing {

namespace {

/// Plays deviations of a motion.
class Deviations {
 public:
  Deviations(const Scene& scene, const MotionSpace& space, const Coordinates& values, const EvidenceOptions& options)
      : scene_(scene), space_(space), values_(values), play_(space.play(values)), options_(options) {}

  const DrivenMotion& play() const { return play_; }
  /// The motion played with a deviation in units of `tolerance`.
  DrivenMotion inexact(const ExecutionTolerance& tolerance, const Deviation& d) const {
    return space_.inexact(play_, tolerance, d);
  }

  /// Stopped, or out of work.
  bool is_over() const { return work_ > options_.work || options_.monitor.stopped(); }
  long work() const { return work_; }  ///< see work_of
  const std::function<bool()>* over() const { return options_.monitor.stop ? &options_.monitor.stop : nullptr; }

  double worst_of(const std::vector<DrivenMotion>& plays) { return worst(peaks_of(scene_, plays)); }
  /// The motion in two other scenes: `change(scene, -1)` and `change(scene, 1)`.
  template <class Change>
  double worst_in(const Change& change) {
    std::vector<double> peaks;
    for (const double side : {-1.0, 1.0}) {
      Scene other = scene_;
      change(other, side);
      peaks.push_back(peaks_of(other, {play_})[0]);
    }
    return worst(peaks);
  }

  /// How far variable k may move one way before the peak exceeds `limit`; NaN where it was stopped.
  double width(int k, double direction, double limit) {
    constexpr int kCoarse = 40, kFine = 24;
    const Variable& variable = space_.variables()[std::size_t(k)];
    const double range = direction > 0 ? variable.upper - values_[k] : values_[k] - variable.lower;
    if (!(range > 0)) return 0;
    double good = 0, bad = range;
    for (const int points : {kCoarse, kFine}) {
      std::vector<DrivenMotion> plays;
      std::vector<double> offsets;
      for (int i = 1; i <= points; ++i) {
        const double share = double(i) / points;
        offsets.push_back(points == kCoarse ? range * std::pow(10.0, 7 * (share - 1)) : good + share * (bad - good));
        Coordinates x = values_;
        x[k] += direction * offsets.back();
        plays.push_back(space_.play(x));
      }
      const auto peaks = peaks_of(scene_, plays);
      if (is_over()) return Evidence::kUnknown;
      const auto first = std::find_if(peaks.begin(), peaks.end(), [&](double p) { return p > limit; }) - peaks.begin();
      if (first == points) return offsets.back();
      bad = offsets[std::size_t(first)];
      if (first > 0) good = offsets[std::size_t(first) - 1];
    }
    return good;
  }

 private:
  std::vector<double> peaks_of(const Scene& scene, const std::vector<DrivenMotion>& plays) {
    if (is_over()) return std::vector<double>(plays.size(), Evidence::kUnknown);
    std::vector<BatchCase> cases;
    for (const DrivenMotion& p : plays) cases.push_back({&scene, &p.sea, p.motion});
    std::vector<LandingPeak> peaks(cases.size());
    batch_peaks(cases, peaks, {.accuracy = options_.accuracy, .over = over()}, options_.threads);
    std::vector<double> out;
    for (const LandingPeak& p : peaks) {
      work_ += work_of(p.work);
      out.push_back(no_landing(p.end)        ? std::numeric_limits<double>::infinity()
                    : p.end == End::kStopped ? Evidence::kUnknown
                                             : p.peak);
    }
    options_.monitor.progress(played_ += long(plays.size()), Evidence::kLandings);
    return out;
  }
  /// NaN where one of them is.
  static double worst(const std::vector<double>& peaks) {
    double out = 0;
    for (const double p : peaks) out = p > out || std::isnan(p) ? p : out;
    return out;
  }

  const Scene& scene_;
  const MotionSpace& space_;
  const Coordinates& values_;
  const DrivenMotion play_;
  const EvidenceOptions& options_;
  long played_ = 0, work_ = 0;
};

}  // namespace

void EvidenceOptions::validate() const {
  SimulateOptions{.accuracy = accuracy}.validate();
  check_count("tolerance_samples", tolerance_samples, 0, 1'000'000'000);
}

Evidence evidence(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                  const EvidenceOptions& options) {
  const ReferenceSpace space(scene, sea);
  return evidence(scene, space, space.values_of(motion), options);
}

Evidence evidence(const Scene& scene, const MotionSpace& space, const Coordinates& values,
                  const EvidenceOptions& options) {
  options.validate(), scene.validate();
  if (values.size() != space.dimension())
    throw InputError("values: " + std::to_string(values.size()) + ": the motion has " +
                     std::to_string(space.dimension()) + " variables");
  Evidence out;
  out.width.assign(std::size_t(space.dimension()), {Evidence::kUnknown, Evidence::kUnknown});
  Deviations player(scene, space, values, options);
  const DrivenMotion& play = player.play();
  const SimulateOptions tight{.accuracy = options.accuracy, .over = player.over()};
  const LandingPeak played = peak_acceleration(scene, play.sea, play.motion, tight);
  out.peak = played.peak;
  out.tolerant.value = Evidence::kUnknown;
  out.work = Evidence::kLandings * work_of(played.work);
  if (out.work > options.work || player.is_over()) return out;
  out.tolerant = tolerant_peak(scene, space, play, tight, options.tolerance_samples, options.seed, options.threads);
  if (!out.tolerant.complete) out.tolerant.value = Evidence::kUnknown;
  constexpr ExecutionTolerance kWide{kDegree, 0.01};
  std::vector<DrivenMotion> angle_deviations, time_deviations;
  for (const double i : {-1.0, 0.0, 1.0})
    for (const double j : {-1.0, 0.0, 1.0}) angle_deviations.push_back(player.inexact(kWide, {i, j, 0}));
  for (const double s : {-1.0, 1.0}) time_deviations.push_back(player.inexact(kWide, {0, 0, s}));
  out.one_degree = player.worst_of(angle_deviations);
  out.ten_milliseconds = player.worst_of(time_deviations);
  out.one_centimetre =
      player.worst_in([](Scene& s, double side) { s.drop.height = std::max(0.0, s.drop.height + 0.01 * side); });
  out.pitch_one_degree = player.worst_in([](Scene& s, double side) { s.drop.pitch += kDegree * side; });
  out.damping_ten_percent = player.worst_in([](Scene& s, double side) {
    if (!s.floor) return;
    s.floor->damping_normal *= 1 + 0.1 * side;
    s.floor->damping_tangential *= 1 + 0.1 * side;
  });
  const double limit = out.peak * (1 + Evidence::kRise);
  for (int k = 0; k < space.dimension(); ++k)
    for (const int side : {0, 1}) out.width[std::size_t(k)][std::size_t(side)] = player.width(k, side ? 1 : -1, limit);
  out.complete = !player.is_over();
  out.work = std::max(out.work, player.work());
  return out;
}

}  // namespace ukemi::landing

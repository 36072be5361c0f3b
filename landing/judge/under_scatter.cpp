#include "landing/judge/under_scatter.hpp"

#include <algorithm>
#include <cmath>

#include "common/checks.hpp"
#include "common/error.hpp"
#include "landing/judge/refined_minimum.hpp"
#include "landing/run/simulate.hpp"
#include "landing/scatter/sampler.hpp"

namespace ukemi::landing {

namespace {

constexpr double kAccuracy = 1e-5;  // peaks to some 1e-4

/// Plays over drops, in parts so that memory stays bounded.
class DropPlayer {
 public:
  DropPlayer(const MotionSpace& space, const UnderScatterOptions& options) : space_(space), options_(options) {}
  std::vector<double> peaks(const DrivenMotion& p, std::span<const ScatteredDrop> drops, const Limits& limits) {
    constexpr std::size_t kPart = 2048;
    std::vector<double> out;
    out.reserve(drops.size());
    for (std::size_t i = 0; i < drops.size(); i += kPart)
      for (const LandingPeak& l : landings_.play(
               {&p, 1}, drops.subspan(i, std::min(kPart, drops.size() - i)),
               {.accuracy = kAccuracy, .limits = limits, .threads = options_.threads, .over = &over_}, &space_)) {
        broken += l.end == End::kBroken, lost += l.joint_lost;
        out.push_back(counted(l, options_.penalty));
      }
    return out;
  }
  bool stopped() const { return over_(); }
  long broken = 0, lost = 0;

 private:
  const MotionSpace& space_;
  const UnderScatterOptions& options_;
  const std::function<bool()> over_ = [this] { return options_.monitor.stopped(); };
  ScatteredLandings landings_;
};

std::vector<double> finite(std::vector<double> x) {
  std::erase_if(x, [](double v) { return !std::isfinite(v); });
  return x;
}

/// A reference that is constant at phi, with the release and move in the air of the planned motion.
Motion holding(double phi, const Motion& planned) {
  Motion m{phi, phi, 1};
  m.reposition = planned.reposition;
  return m;
}

}  // namespace

Scatter scatter_for(const std::optional<Scatter>& requested, const Scene& scene) {
  return requested ? *requested : scene.scatter.value_or(Scatter::assumed());
}

void RobustOptions::validate() const {
  constexpr long kMost = 1'000'000;
  check_count("samples", samples, 1, kMost), check_count("judging", judging, 1, kMost);
  check_not_negative("inflate", inflate), check_not_negative("penalty", penalty);
  if (measure) measure->validate();
  if (scatter) scatter->validate();
}

void UnderScatterOptions::validate() const {
  check_count("samples", samples, 1, 10'000'000);
  measure.validate(), limits.validate();
  check_not_negative("penalty", penalty), check_not_negative("rate", rate);
}

std::shared_ptr<const Robust> robust_goal(const DropModel& model, const RobustOptions& options, std::uint64_t seed) {
  options.validate();
  if (!options.measure) throw InputError("robust: a measure is needed");
  auto robust = std::make_shared<Robust>();
  robust->measure = *options.measure, robust->penalty = options.penalty;
  robust->drops = model.even(options.samples, seed);
  robust->judging = model.even(options.judging, selection_seed(seed));
  return robust;
}

UnderScatter under_scatter(const DropModel& model, const MotionSpace& space, const DrivenMotion& planned,
                           const UnderScatterOptions& options) {
  options.validate();
  const std::vector<ScatteredDrop> drops = model.independent(options.samples, fresh_seed(options.seed));
  DropPlayer player(space, options);
  UnderScatter out;
  Limits limits = options.limits;
  if (model.scene().joint) limits.joint = *model.scene().joint;
  const std::vector<double> peaks = player.peaks(planned, drops, limits);
  out.planned = distribution(peaks), out.measured = estimated(options.measure, peaks);
  out.broken = player.broken, out.lost = player.lost;
  out.from_floor = std::count_if(drops.begin(), drops.end(), [](const ScatteredDrop& d) { return d.from_floor; });
  if (options.nominal) {
    const std::vector<double> nominal_peaks = player.peaks({*options.nominal, planned.sea}, drops, limits);
    out.nominal = distribution(nominal_peaks);
    const std::vector<double> followed = finite(peaks);
    out.histogram = histogram(followed, finite(nominal_peaks), distribution(followed).q99.value);
  }
  const std::function<bool()> over = [&] { return options.monitor.stopped(); };
  for (std::size_t k = 0; options.rate > 0 && k < std::min(UnderScatter::kShown, drops.size()); ++k) {
    const DrivenMotion p = drops[k].played(space, planned);
    out.shown.push_back(
        simulate(drops[k].scene, p.sea, p.motion, {.accuracy = kAccuracy, .over = &over}, options.rate));
  }
  const auto held = [&](double phi) { return DrivenMotion{holding(phi, planned.motion), planned.sea}; };
  out.held = distribution(player.peaks({kHeld, planned.sea}, drops, limits));
  constexpr std::size_t kPostureDrops = 128;
  const auto first_drops =
      std::span(drops).first(std::min(kPostureDrops, drops.size()));  // of measured ones there may be fewer
  const auto [low, high] = model.scene().search.phi;
  constexpr int kOneByOne = 1;  // each plays its drops by all threads
  out.posture_phi = refined_minimum(low, high, {.points = 25, .rounds = 2, .reach = 1}, kOneByOne, [&](double phi) {
                      if (player.stopped()) return std::numeric_limits<double>::infinity();
                      std::vector<double> of_posture = player.peaks(held(phi), first_drops, limits);
                      return options.measure.of(of_posture);
                    }).phi;
  std::vector<double> of_posture = player.peaks(held(out.posture_phi), drops, limits);
  out.posture = distribution(of_posture), out.posture_value = options.measure.of(of_posture);
  out.complete = !player.stopped();
  return out;
}

}  // namespace ukemi::landing

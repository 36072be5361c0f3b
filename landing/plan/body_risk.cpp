#include "landing/plan/body_risk.hpp"

#include <algorithm>
#include <limits>

#include "common/checks.hpp"
#include "landing/body/load.hpp"
#include "landing/judge/census.hpp"
#include "landing/lanes/body_batch.hpp"

namespace ukemi::landing {

void BodyRiskOptions::validate() const { check_count("samples", samples, 1, 10'000'000); }

namespace {

constexpr double kAccuracy = 1e-6;  // of a landing's steps
constexpr long kChunk = 2048;       // landings that are held in memory at once

using Kind = RiskEvent::Kind;

/// The events of a motion, and the load that each is beyond the rating of.
struct Events {
  std::vector<RiskEvent> all;
  std::vector<Load> loads;  ///< of the scene, then the ratings of the drives, which limit nothing

  explicit Events(const BodyScene& scene) : loads(scene.loads) {
    for (std::size_t i = 0; i < loads.size(); ++i) {
      const Load& l = loads[i];
      RiskEvent e{.kind = Kind::kLoad, .load = int(i), .limit = l.rating};
      if (l.kind == Load::Kind::kTouch) e.kind = Kind::kTouch, e.point = l.index;
      if (l.kind == Load::Kind::kAngle && l.limit && l.rating == 0) e.kind = Kind::kStops, e.joint = l.index;
      all.push_back(e);
    }
    for (std::size_t i = 0; i < scene.robot.joints.size(); ++i) {
      const Joint& j = scene.robot.joints[i];
      if (j.driven() && j.speed_max) add_rating(scene.robot, Kind::kSpeed, Load::Kind::kMotorSpeed, i, *j.speed_max);
      if (j.driven() && j.motor_torque_max)
        add_rating(scene.robot, Kind::kTorque, Load::Kind::kMotorTorque, i, *j.motor_torque_max);
    }
  }

 private:
  void add_rating(const Robot& robot, Kind kind, Load::Kind load, std::size_t joint, double rating) {
    all.push_back({.kind = kind, .joint = int(joint), .limit = rating});
    loads.push_back(limit(robot, load, joint, rating)), loads.back().limit = false;
  }
};

class DropRunner {
 public:
  DropRunner(const BodyRiskOptions& options, long planned) : options_(options), planned_(planned) {}
  bool stopped() const { return options_.monitor.stopped(); }
  void played(long landings) { options_.monitor.progress(played_ += landings, planned_); }
  /// Of the acceleration of the point that counts, as the model's drops have no loads.
  std::vector<double> peaks(std::span<const BodyDrop> drops, const BodyMotion& motion) const {
    return peaks_over(drops, motion, kAccuracy, options_.threads, &over_).peaks;
  }
  std::vector<BodyLanding> landings(std::span<BodyDrop> drops, const BodyMotion& motion,
                                    const std::vector<Load>& loads) const {
    std::vector<BodyMotion> played(drops.size());
    std::vector<BodyBatchCase> cases;
    for (std::size_t k = 0; k < drops.size(); ++k) {
      drops[k].scene.loads = loads, played[k] = drops[k].played(motion);
      cases.push_back({&drops[k].scene, &played[k]});
    }
    std::vector<BodyLanding> out(drops.size());
    body_batch_peaks(cases, out, {.accuracy = kAccuracy, .over = &over_}, options_.threads);
    return out;
  }

 private:
  const BodyRiskOptions& options_;
  const std::function<bool()> over_ = [this] { return stopped(); };
  long planned_, played_ = 0;
};

void play_drops(BodyRisk& out, const BodyDropModel& model, const Events& events, const BodyMotion& motion, long samples,
                const BodyRiskOptions& options, DropRunner& runner) {
  const BodyMotion hold = held_posture(model.scene());
  const auto drops_of = [&](long first, long count) {
    const std::vector<BodyDrop>& measured = model.measured();
    return measured.empty() ? model.even(count, options.seed, first)
                            : std::vector<BodyDrop>(measured.begin() + first, measured.begin() + first + count);
  };
  PeakCensus census;
  WorstDrops worst;
  for (long first = 0; first < samples; first += kChunk) {
    std::vector<BodyDrop> drops = drops_of(first, std::min(kChunk, samples - first));
    const auto of_held = std::span<const BodyDrop>(drops).first(
        std::size_t(std::clamp(PeakRisk::kHeldDrops - first, 0L, long(drops.size()))));
    const std::vector<double> held_peaks = runner.peaks(of_held, hold);
    const std::vector<BodyLanding> landings = runner.landings(drops, motion, events.loads);
    if (runner.stopped()) break;
    for (const double x : held_peaks) census.add_held(x);
    for (const BodyDrop& d : drops) out.from_floor += d.from_floor;
    for (std::size_t i = 0; i < landings.size(); ++i) {
      const BodyLanding& l = landings[i];
      if (!census.add_motion(no_landing(l.end) ? std::numeric_limits<double>::infinity() : l.peak)) continue;
      worst.add(l.peak, first + long(i));
      out.lost += l.joint_lost;
      census.add_contact(l);
      bool broken = false;
      const std::vector<LoadPeak> peaks = loads_of(drops[i].scene, l);
      for (std::size_t k = 0; k < peaks.size(); ++k) {
        const Load& load = events.loads[k];
        const bool occurs = peaks[k].value > rating_limit(load, model.scene().robot);
        out.events[k].drops += occurs, broken = broken || (occurs && load.limit);
      }
      out.broken += broken;
    }
    worst.sort();
    runner.played(long(drops.size() + of_held.size()));
  }
  census.report(out);
  for (const auto& [peak, index] : worst.drops()) out.worst.push_back({drops_of(index, 1).front(), peak});
}

}  // namespace

BodyRisk body_risk(const BodyScene& scene, const BodyMotion& motion, const BodyRiskOptions& options) {
  options.validate(), validate(scene.robot, motion);
  BodyRisk out;
  const bool drawn = !options.measured;
  if (drawn) out.scatter = scatter_for(options.scatter, scene);
  out.assumed = drawn && !options.scatter && !scene.scatter;
  const Events events(scene);
  out.events = events.all;
  BodyScene bare = scene;
  bare.loads.clear();
  std::vector<BodyDrop> measured;
  if (!drawn) measured = *options.measured;
  for (BodyDrop& d : measured) d.scene.loads.clear();
  const BodyDropModel model =
      drawn ? BodyDropModel(bare, *out.scatter, options.drops) : BodyDropModel::measured(bare, measured);
  const long samples = !drawn ? long(measured.size()) : model.scatters() ? options.samples : 1;
  const IndexPlan plan(model.sampler(), samples);
  DropRunner runner(options, samples + std::min(samples, PeakRisk::kHeldDrops) + plan.landings());
  play_drops(out, model, events, motion, samples, options, runner);
  out.why_none = drawn ? plan.why_none(runner.stopped()) : PeakRisk::WhyNone::kMeasured;
  if (out.why_none != PeakRisk::WhyNone::kThere) return out;
  plan.compute(out, kChunk, options.seed, options.threads,
               [&](const std::vector<double>& points, long count) -> std::optional<std::vector<double>> {
                 std::vector<double> peaks = runner.peaks(model.drops(points, count), motion);
                 if (runner.stopped()) return std::nullopt;
                 runner.played(count);
                 return peaks;
               });
  return out;
}

}  // namespace ukemi::landing

#include "landing/plan/body_risk.hpp"

#include <algorithm>
#include <limits>

#include "common/checks.hpp"
#include "common/parallel.hpp"
#include "landing/body/load.hpp"
#include "landing/judge/census.hpp"

namespace ukemi::landing {

void BodyRiskOptions::validate() const { check_count("samples", samples, 1, 10'000'000); }

namespace {

constexpr double kAccuracy = 1e-6, kBalanced = 1e-7;  // of a peak; of a landing whose energy balance is checked
constexpr long kChunk = 2048;                         // landings that are held in memory at once

using Kind = RiskEvent::Kind;

std::vector<RiskEvent> events_of(const BodyScene& scene) {
  const Robot& robot = scene.robot;
  std::vector<RiskEvent> out;
  for (std::size_t i = 0; i < scene.loads.size(); ++i) {
    const Load& l = scene.loads[i];
    RiskEvent e{.kind = Kind::kLoad, .load = int(i), .limit = l.rating};
    if (l.kind == Load::Kind::kTouch) e.kind = Kind::kTouch, e.point = l.index;
    if (l.kind == Load::Kind::kAngle && l.limit && l.rating == 0) e.kind = Kind::kStops, e.joint = l.index;
    out.push_back(e);
  }
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const Joint& j = robot.joints[i];
    if (!j.driven()) continue;
    if (j.speed_max) out.push_back({.kind = Kind::kSpeed, .joint = int(i), .limit = *j.speed_max});
    if (j.motor_torque_max) out.push_back({.kind = Kind::kTorque, .joint = int(i), .limit = *j.motor_torque_max});
  }
  return out;
}
bool exceeded(const RiskEvent& e, const BodyScene& scene, const BodyLanding& l) {
  if (e.load >= 0)
    return loads_of(scene, l)[std::size_t(e.load)].value > rating_limit(scene.loads[std::size_t(e.load)], scene.robot);
  const JointDemands& d = l.demands[std::size_t(e.joint)];
  if (e.kind == Kind::kSpeed) return d.motor_speed > rating_limit(e.limit);
  return d.motor_torque > torque_limit(scene.robot.joints[std::size_t(e.joint)], e.limit);
}

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
    std::vector<BodyLanding> out(drops.size());
    parallel_for(int(drops.size()), options_.threads, [&](int k) {
      BodyDrop& d = drops[std::size_t(k)];
      d.scene.loads = loads;
      if (!over_()) out[std::size_t(k)] = simulate(d.scene, d.played(motion), {.accuracy = kBalanced, .over = &over_});
    });
    return out;
  }

 private:
  const BodyRiskOptions& options_;
  const std::function<bool()> over_ = [this] { return stopped(); };
  long planned_, played_ = 0;
};

void play_drops(BodyRisk& out, const BodyDropModel& model, const BodyScene& scene, const BodyMotion& motion,
                long samples, const BodyRiskOptions& options, DropRunner& runner) {
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
    const std::vector<BodyLanding> landings = runner.landings(drops, motion, scene.loads);
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
      for (RiskEvent& e : out.events) {
        const bool occurs = exceeded(e, scene, l);
        e.drops += occurs;
        broken = broken || (occurs && e.load >= 0 && scene.loads[std::size_t(e.load)].limit);
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
  out.events = events_of(scene);
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
  play_drops(out, model, scene, motion, samples, options, runner);
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

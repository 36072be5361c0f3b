#include "landing/judge/risk.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/checks.hpp"
#include "common/error.hpp"
#include "landing/judge/answer.hpp"
#include "landing/judge/census.hpp"
#include "landing/scatter/scattered.hpp"

namespace ukemi::landing {

void RiskOptions::validate() const { check_count("samples", samples, 1, 10'000'000); }

namespace {

constexpr double kAccuracy = 1e-6;  // at 1e-5 one peak in a hundred is off by up to 4e-3
constexpr long kChunk = 16'384;     // landings that are held in memory at once

/// The peak, infinite where there is none.
double peak_of(const LandingPeak& l) { return counted(l, std::numeric_limits<double>::infinity()); }
bool followed(const LandingPeak& l) { return std::isfinite(peak_of(l)); }

/// Plays drops, and reports the landings as progress.
class DropRunner {
 public:
  DropRunner(const RiskOptions& options, long planned) : options_(options), planned_(planned) {}

  /// Whether a play was cut off; all later ones are too.
  bool stopped() const { return stopped_; }
  const std::vector<LandingPeak>& play(ScatteredLandings& landings, const DrivenMotion& play,
                                       std::span<const ScatteredDrop> drops, const Limits& limits = {}) {
    const auto& out = landings.play({&play, 1}, drops,
                                    {.accuracy = kAccuracy,
                                     .limits = limits,
                                     .threads = options_.threads,
                                     .over = options_.monitor.stop ? &options_.monitor.stop : nullptr});
    stopped_ = stopped_ || std::any_of(out.begin(), out.end(), [](auto& l) { return l.end == End::kStopped; }) ||
               options_.monitor.stopped();
    return out;
  }
  void played(long landings) { options_.monitor.progress(played_ += landings, planned_); }

 private:
  const RiskOptions& options_;
  long planned_, played_ = 0;
  bool stopped_ = false;
};

/// The limit of an event; none for a touch, which the landing reports.
Limits limits_of(const RiskEvent& event, const Scene& scene) {
  Limits out;
  if (event.kind == RiskEvent::Kind::kSpeed) out.motor_speed = event.limit;
  if (event.kind == RiskEvent::Kind::kTorque) out.motor_torque = event.limit;
  if (event.kind == RiskEvent::Kind::kStops) out.joint = *scene.joint;
  return out;
}

std::vector<RiskEvent> events_of(const Scene& scene, const Actuator& actuator, const RiskOptions& options) {
  using Kind = RiskEvent::Kind;
  std::vector<RiskEvent> out;
  for (int p = 0; p < kPoints; ++p)
    if (options.forbidden[std::size_t(p)]) out.push_back({.kind = Kind::kTouch, .point = p});
  if (actuator.speed_max) out.push_back({.kind = Kind::kSpeed, .limit = *actuator.speed_max});
  if (actuator.motor_torque_max) out.push_back({.kind = Kind::kTorque, .limit = *actuator.motor_torque_max});
  if (scene.joint) out.push_back({.kind = Kind::kStops});
  return out;
}

/// Plays a plan and counts exceeded limits: landings that keep all limits are played once, the others again without
/// limits and once with each.
class LimitCounter {
 public:
  LimitCounter(const DrivenMotion& planned, std::vector<RiskEvent>& events, const Scene& scene) : planned_(planned) {
    for (RiskEvent& e : events) {
      const Limits l = limits_of(e, scene);
      if (!l.any()) continue;
      event_limits_.push_back({&e, l});
      all_limits_.motor_speed = std::min(all_limits_.motor_speed, l.motor_speed);
      all_limits_.motor_torque = std::min(all_limits_.motor_torque, l.motor_torque);
      if (l.joint_stops()) all_limits_.joint = l.joint;
    }
  }

  /// The landings without limits. Where the runner stops, they are incomplete and not counted.
  const std::vector<LandingPeak>& land(std::span<const ScatteredDrop> drops, DropRunner& runner) {
    landed_ = runner.play(landings_, planned_, drops, all_limits_);
    beyond_stops_.assign(drops.size(), false);
    std::vector<std::size_t> indices;
    std::vector<ScatteredDrop> broken;
    for (std::size_t i = 0; i < drops.size(); ++i)
      if (landed_[i].end == End::kBroken) indices.push_back(i), broken.push_back(drops[i]);
    if (broken.empty()) return landed_;
    const std::vector<LandingPeak>& unlimited = runner.play(landings_, planned_, broken);
    for (std::size_t k = 0; k < indices.size(); ++k) landed_[indices[k]] = unlimited[k];
    std::vector<std::vector<std::size_t>> breaking;
    for (const auto& [event, limits] : event_limits_) breaking.push_back(breaking_of(limits, indices, broken, runner));
    for (std::size_t k = 0; k < breaking.size() && !runner.stopped(); ++k) {
      RiskEvent& event = *event_limits_[k].first;
      event.drops += long(breaking[k].size());
      if (event.kind == RiskEvent::Kind::kStops)
        for (const std::size_t i : breaking[k]) beyond_stops_[i] = true;
    }
    return landed_;
  }
  /// Whether the joint leaves its stops, in each of these landings.
  const std::vector<bool>& beyond_stops() const { return beyond_stops_; }

 private:
  /// Which of these drops, of those that can be followed, break these limits; each breaks some limit.
  std::vector<std::size_t> breaking_of(const Limits& limits, const std::vector<std::size_t>& indices,
                                       std::span<const ScatteredDrop> drops, DropRunner& runner) {
    const auto* limited = event_limits_.size() > 1 ? &runner.play(landings_, planned_, drops, limits) : nullptr;
    std::vector<std::size_t> out;
    for (std::size_t k = 0; k < indices.size(); ++k)
      if (followed(landed_[indices[k]]) && (!limited || (*limited)[k].end == End::kBroken)) out.push_back(indices[k]);
    return out;
  }

  DrivenMotion planned_;
  std::vector<std::pair<RiskEvent*, Limits>> event_limits_;
  Limits all_limits_;
  ScatteredLandings landings_;
  std::vector<LandingPeak> landed_;
  std::vector<bool> beyond_stops_;
};

/// Collects the results of the drops.
class RiskCensus {
 public:
  RiskCensus(std::vector<RiskEvent>& events) : events_(events) {}

  void add(long first, std::span<const ScatteredDrop> drops, const std::vector<LandingPeak>& landed,
           const std::vector<bool>& beyond_stops, const std::vector<LandingPeak>& held) {
    for (const LandingPeak& l : held) peaks_.add_held(peak_of(l)), held_lost_ += followed(l) && l.joint_lost;
    for (const ScatteredDrop& d : drops) from_floor_ += d.from_floor;
    for (std::size_t i = 0; i < landed.size(); ++i) {
      const LandingPeak& l = landed[i];
      if (!peaks_.add_motion(peak_of(l))) continue;
      lost_ += l.joint_lost;
      worst_.add(l.peak, first + long(i));
      peaks_.add_contact(l);
      bool broken = beyond_stops[i];
      for (RiskEvent& e : events_) {
        const bool touched = e.kind == RiskEvent::Kind::kTouch && l.contacts.touched(Point(e.point));
        e.drops += touched, broken = broken || touched;
      }
      broken_ += broken;
    }
    worst_.sort();
  }

  void report(Risk& out) const {
    peaks_.report(out);
    out.lost = lost_, out.held_lost = held_lost_, out.from_floor = from_floor_, out.broken = broken_;
  }
  const std::vector<std::pair<double, long>>& worst() const { return worst_.drops(); }

 private:
  std::vector<RiskEvent>& events_;
  PeakCensus peaks_;
  WorstDrops worst_;
  long lost_ = 0, held_lost_ = 0, from_floor_ = 0, broken_ = 0;
};

}  // namespace

Risk risk(const DropModel& model, const Actuator& actuator, const Motion& motion, const RiskOptions& options) {
  options.validate(), validate(actuator), validate(motion);
  const bool drawn = options.measured.empty(), scatters = !drawn || model.dimension() > 0;
  const long n = !drawn ? long(options.measured.size()) : scatters ? options.samples : 1;
  const DrivenMotion planned{motion, actuator.sea}, held{kHeld, actuator.sea};
  Risk out;
  out.events = events_of(model.scene(), actuator, options);
  const IndexPlan plan(model.sampler(), drawn ? options.samples : 0);
  DropRunner runner(options, n + (drawn ? std::min(n, Risk::kHeldDrops) : n) + plan.landings());
  RiskCensus census(out.events);
  LimitCounter limit_counter(planned, out.events, model.scene());
  ScatteredLandings held_landings;
  for (long first = 0; first < n && !runner.stopped(); first += kChunk) {
    const long count = std::min(kChunk, n - first);
    std::vector<ScatteredDrop> generated;
    if (drawn) generated = model.even(count, options.seed, first);
    const std::span<const ScatteredDrop> drops =
        drawn ? std::span<const ScatteredDrop>(generated)
              : std::span(options.measured).subspan(std::size_t(first), std::size_t(count));
    const auto held_drops = drops.first(std::size_t(drawn ? std::clamp(Risk::kHeldDrops - first, 0L, count) : count));
    const std::vector<LandingPeak>& landed_held = runner.play(held_landings, held, held_drops);
    const std::vector<LandingPeak>& landed = limit_counter.land(drops, runner);
    if (runner.stopped()) break;
    census.add(first, drops, landed, limit_counter.beyond_stops(), landed_held);
    runner.played(count + long(held_drops.size()));
  }
  census.report(out);
  for (const auto& [peak, index] : census.worst())
    out.worst.push_back(
        {drawn ? model.even(1, options.seed, index).front() : options.measured[std::size_t(index)], peak});
  out.why_none = drawn ? plan.why_none(runner.stopped()) : Risk::WhyNone::kMeasured;
  if (out.why_none != Risk::WhyNone::kThere) return out;
  ScatteredLandings index_landings;
  plan.compute(out, kChunk, options.seed, options.threads,
               [&](const std::vector<double>& points, long count) -> std::optional<std::vector<double>> {
                 const std::vector<LandingPeak>& l = runner.play(index_landings, planned, model.drops(points, count));
                 if (runner.stopped()) return std::nullopt;
                 runner.played(count);
                 std::vector<double> peaks;
                 for (const LandingPeak& x : l) peaks.push_back(peak_of(x));
                 return peaks;
               });
  return out;
}

}  // namespace ukemi::landing

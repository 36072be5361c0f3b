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

/// Plays chunk after chunk, and reports the landings as progress.
class Course {
 public:
  Course(const RiskOptions& options, long planned) : options_(options), planned_(planned) {}

  /// Whether the last play was cut off, as all will be from then on.
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

/// The limit that an event passes; none for a touch, which the landing's own result has.
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

/// Lands a plan, and counts how often its limits are passed: what keeps all of them is followed to its end at once, the
/// others once more without limits and once with each.
class Lander {
 public:
  Lander(const DrivenMotion& planned, std::vector<RiskEvent>& events, const Scene& scene) : planned_(planned) {
    for (RiskEvent& e : events) {
      const Limits l = limits_of(e, scene);
      if (!l.any()) continue;
      each_.push_back({&e, l});
      all_.motor_speed = std::min(all_.motor_speed, l.motor_speed);
      all_.motor_torque = std::min(all_.motor_torque, l.motor_torque);
      if (l.joint_stops()) all_.joint = l.joint;
    }
  }

  /// The landings without limits. What a course that has stopped leaves is of no use, and not counted.
  const std::vector<LandingPeak>& land(std::span<const ScatteredDrop> drops, Course& course) {
    landed_ = course.play(landings_, planned_, drops, all_);
    std::vector<std::size_t> places;
    std::vector<ScatteredDrop> broken;
    for (std::size_t i = 0; i < drops.size(); ++i)
      if (landed_[i].end == End::kBroken) places.push_back(i), broken.push_back(drops[i]);
    if (broken.empty()) return landed_;
    const std::vector<LandingPeak>& whole = course.play(landings_, planned_, broken);
    for (std::size_t k = 0; k < places.size(); ++k) landed_[places[k]] = whole[k];
    std::vector<long> counts;
    for (const auto& [event, limits] : each_) counts.push_back(broken_by(limits, places, broken, course));
    for (std::size_t k = 0; k < counts.size() && !course.stopped(); ++k) each_[k].first->drops += counts[k];
    return landed_;
  }

 private:
  /// How many of these drops, of those that can be followed, break these limits; all break some.
  long broken_by(const Limits& limits, const std::vector<std::size_t>& places, std::span<const ScatteredDrop> drops,
                 Course& course) {
    const auto* each = each_.size() > 1 ? &course.play(landings_, planned_, drops, limits) : nullptr;
    long out = 0;
    for (std::size_t k = 0; k < places.size(); ++k)
      out += followed(landed_[places[k]]) && (!each || (*each)[k].end == End::kBroken);
    return out;
  }

  DrivenMotion planned_;
  std::vector<std::pair<RiskEvent*, Limits>> each_;
  Limits all_;
  ScatteredLandings landings_;
  std::vector<LandingPeak> landed_;
};

/// What is counted while the drops are played.
class Census {
 public:
  Census(std::vector<RiskEvent>& events) : events_(events) {}

  void add(long first, std::span<const ScatteredDrop> drops, const std::vector<LandingPeak>& landed,
           const std::vector<LandingPeak>& held) {
    for (const LandingPeak& l : held) peaks_.held(peak_of(l)), held_lost_ += followed(l) && l.joint_lost;
    for (const ScatteredDrop& d : drops) from_floor_ += d.from_floor;
    for (std::size_t i = 0; i < landed.size(); ++i) {
      const LandingPeak& l = landed[i];
      if (!peaks_.motion(peak_of(l))) continue;
      lost_ += l.joint_lost;
      worst_.emplace_back(-l.peak, first + long(i));
      const int n = l.peak_contact;
      peaks_.contact(n + 1, n < 0 ? -1 : int(l.contacts[n]));
      for (RiskEvent& e : events_)
        if (e.kind == RiskEvent::Kind::kTouch) e.drops += l.contacts.touched(Point(e.point));
    }
    const auto kept = std::min(worst_.size(), std::size_t(Risk::kWorst));
    std::partial_sort(worst_.begin(), worst_.begin() + long(kept), worst_.end());
    worst_.resize(kept);
  }

  void finish(Risk& out) const {
    peaks_.finish(out);
    out.lost = lost_, out.held_lost = held_lost_, out.from_floor = from_floor_;
  }
  /// Places of the worst drops, and their peaks below 0.
  const std::vector<std::pair<double, long>>& worst() const { return worst_; }

 private:
  std::vector<RiskEvent>& events_;
  PeakCensus peaks_;
  std::vector<std::pair<double, long>> worst_;
  long lost_ = 0, held_lost_ = 0, from_floor_ = 0;
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
  Course course(options, n + (drawn ? std::min(n, Risk::kHeldDrops) : n) + plan.landings());
  Census census(out.events);
  Lander lander(planned, out.events, model.scene());
  ScatteredLandings of_held;
  for (long first = 0; first < n && !course.stopped(); first += kChunk) {
    const long count = std::min(kChunk, n - first);
    std::vector<ScatteredDrop> made;
    if (drawn) made = model.even(count, options.seed, first);
    const std::span<const ScatteredDrop> drops =
        drawn ? std::span<const ScatteredDrop>(made)
              : std::span(options.measured).subspan(std::size_t(first), std::size_t(count));
    const auto held_drops = drops.first(std::size_t(drawn ? std::clamp(Risk::kHeldDrops - first, 0L, count) : count));
    const std::vector<LandingPeak>& landed_held = course.play(of_held, held, held_drops);
    const std::vector<LandingPeak>& landed = lander.land(drops, course);
    if (course.stopped()) break;
    census.add(first, drops, landed, landed_held);
    course.played(count + long(held_drops.size()));
  }
  census.finish(out);
  for (const auto& [peak, place] : census.worst())
    out.worst.push_back(
        {drawn ? model.even(1, options.seed, place).front() : options.measured[std::size_t(place)], -peak});
  out.why_none = drawn ? plan.why_none(course.stopped()) : Risk::WhyNone::kMeasured;
  if (out.why_none != Risk::WhyNone::kThere) return out;
  ScatteredLandings of_indices;
  plan.work_out(out, kChunk, options.seed, options.threads,
                [&](const std::vector<double>& points, long count) -> std::optional<std::vector<double>> {
                  const std::vector<LandingPeak>& l = course.play(of_indices, planned, model.drops(points, count));
                  if (course.stopped()) return std::nullopt;
                  course.played(count);
                  std::vector<double> peaks;
                  for (const LandingPeak& x : l) peaks.push_back(peak_of(x));
                  return peaks;
                });
  return out;
}

}  // namespace ukemi::landing

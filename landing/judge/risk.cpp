#include "landing/judge/risk.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "common/checks.hpp"
#include "common/error.hpp"
#include "landing/judge/answer.hpp"
#include "landing/scatter/scattered.hpp"
#include "landing/scatter/sobol.hpp"

namespace ukemi::landing {

void RiskOptions::validate() const { check_count("samples", samples, 1, 10'000'000); }

namespace {

constexpr double kAccuracy = 1e-6;   // at 1e-5 one peak in a hundred is off by up to 4e-3
constexpr long kChunk = 16'384;      // landings that are held in memory at once
constexpr long kHeldDrops = kChunk;  // that the held reference is played over: its tail is known to 1 % from so many

/// The peak, infinite where there is none.
double peak_of(const LandingPeak& l) { return counted(l, std::numeric_limits<double>::infinity()); }
bool followed(const LandingPeak& l) { return std::isfinite(peak_of(l)); }

/// Plays a chunk after the other, and tells of the landings.
class Course {
 public:
  Course(const RiskOptions& options, long planned) : options_(options), planned_(planned) {}

  /// Whether the last play was cut off, as all will be from then on.
  bool stopped() const { return stopped_; }
  const std::vector<LandingPeak>& play(ScatteredLandings& landings, const Play& play,
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
  void tell(long landings) { options_.monitor.progress(played_ += landings, planned_); }

 private:
  const RiskOptions& options_;
  long planned_, played_ = 0;
  bool stopped_ = false;
};

/// What limit an event is the passing of; none for a touch, which a landing tells itself.
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
  Lander(const Play& planned, std::vector<RiskEvent>& events, const Scene& scene) : planned_(planned) {
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

  Play planned_;
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
    for (const LandingPeak& l : held)
      if (followed(l)) held_.push_back(l.peak), held_lost_ += l.joint_lost;
    for (const ScatteredDrop& d : drops) from_floor_ += d.from_floor;
    held_played_ += long(held.size());
    for (std::size_t i = 0; i < landed.size(); ++i) {
      const LandingPeak& l = landed[i];
      if (!followed(l)) continue;
      peaks_.push_back(l.peak), lost_ += l.joint_lost;
      worst_.emplace_back(-l.peak, first + long(i));
      const int n = l.peak_contact;
      ++contacts_[{n + 1, n < 0 ? -1 : int(l.contacts[n])}];
      for (RiskEvent& e : events_)
        if (e.kind == RiskEvent::Kind::kTouch) e.drops += l.contacts.touched(Point(e.point));
    }
    played_ += long(landed.size());
    const auto kept = std::min(worst_.size(), std::size_t(Risk::kWorst));
    std::partial_sort(worst_.begin(), worst_.begin() + long(kept), worst_.end());
    worst_.resize(kept);
  }

  void finish(Risk& out) const {
    out.peaks = distribution(peaks_), out.held = distribution(held_);
    out.failed = played_ - long(peaks_.size()), out.held_failed = held_played_ - long(held_.size());
    out.lost = lost_, out.held_lost = held_lost_, out.from_floor = from_floor_;
    for (const auto& [contact, drops] : contacts_) out.contacts.push_back({contact.first, contact.second, drops});
    std::stable_sort(out.contacts.begin(), out.contacts.end(), [](auto& a, auto& b) { return a.drops > b.drops; });
    out.histogram = histogram(peaks_, held_, out.peaks.q99.value);
  }
  /// Places of the worst drops, and their peaks below 0.
  const std::vector<std::pair<double, long>>& worst() const { return worst_; }

 private:
  std::vector<RiskEvent>& events_;
  std::vector<double> peaks_, held_;
  std::vector<std::pair<double, long>> worst_;
  std::map<std::pair<int, int>, long> contacts_;
  long played_ = 0, held_played_ = 0, lost_ = 0, held_lost_ = 0, from_floor_ = 0;
};

void add_indices(Risk& out, const DropModel& model, IndexPlan& plan, const Play& planned, const RiskOptions& options,
                 Course& course) {
  ScatteredLandings landings;
  const long part = std::max(1L, kChunk / long(plan.blocks()));
  for (long first = 0; first < plan.base_points(); first += part) {
    const long count = std::min(part, plan.base_points() - first);
    const std::vector<ScatteredDrop> drops =
        model.drops(plan.points(count, options.seed, first), count * long(plan.blocks()));
    const std::vector<LandingPeak>& l = course.play(landings, planned, drops);
    if (course.stopped()) {
      out.why_none = Risk::WhyNone::kStopped;
      return;
    }
    course.tell(long(l.size()));
    std::vector<double> peaks;
    for (const LandingPeak& x : l) peaks.push_back(peak_of(x));
    plan.add(peaks);
  }
  plan.finish(out, options.seed, options.threads);
}

}  // namespace

IndexPlan::IndexPlan(const Sampler& sampler, long samples) : sampler_(&sampler), values_(sampler.groups().size() + 2) {
  if (samples > 0 && sampler.groups().size() > 1)
    n_ = std::max(2L, std::lround(std::exp2(std::round(std::log2(double(samples) / double(blocks()))))));
}
std::vector<double> IndexPlan::points(long count, std::uint64_t seed, long first) const {
  const auto d = std::size_t(sampler_->dimension());
  const std::vector<double> both = ScrambledSobol(2 * int(d), seed).points(count, first);
  std::vector<double> out;
  out.reserve(std::size_t(count) * blocks() * d);
  for (std::size_t block = 0; block < blocks(); ++block)
    for (std::size_t i = 0; i < both.size(); i += 2 * d) {
      const auto a = both.begin() + long(i), b = a + long(d);
      out.insert(out.end(), block == 1 ? b : a, (block == 1 ? b : a) + long(d));
      if (block < 2) continue;
      const ScatterGroup& g = sampler_->groups()[block - 2];
      std::copy_n(b + g.first, g.count, out.end() - long(d) + g.first);
    }
  return out;
}
void IndexPlan::add(std::span<const double> peaks) {
  const std::size_t count = peaks.size() / blocks();
  for (std::size_t i = 0; i < peaks.size(); ++i) values_[i / count].push_back(peaks[i]);
}
void IndexPlan::finish(PeakRisk& out, std::uint64_t seed, int threads) const {
  out.index_landings = landings();
  for (const auto& block : values_)
    out.index_failed += std::count_if(block.begin(), block.end(), [](double x) { return !std::isfinite(x); });
  const auto indices = sobol_indices(values_[0], values_[1], std::span(values_).subspan(2), seed, threads);
  for (std::size_t g = 0; g < indices.size(); ++g)
    out.uncertainties.push_back({sampler_->groups()[g].name, indices[g]});
  std::stable_sort(out.uncertainties.begin(), out.uncertainties.end(),
                   [](auto& a, auto& b) { return a.index.total.value > b.index.total.value; });
}

Risk risk(const DropModel& model, const Actuator& actuator, const Motion& motion, const RiskOptions& options) {
  options.validate(), validate(actuator), validate(motion);
  using WhyNone = Risk::WhyNone;
  const bool drawn = options.measured.empty(), scatters = !drawn || model.dimension() > 0;
  const long n = !drawn ? long(options.measured.size()) : scatters ? options.samples : 1;
  const Play planned{motion, actuator.sea}, held{kHeld, actuator.sea};
  Risk out;
  out.events = events_of(model.scene(), actuator, options);
  IndexPlan plan(model.sampler(), drawn ? options.samples : 0);
  Course course(options, n + (drawn ? std::min(n, kHeldDrops) : n) + plan.landings());
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
    const auto held_drops = drops.first(std::size_t(drawn ? std::clamp(kHeldDrops - first, 0L, count) : count));
    const std::vector<LandingPeak>& landed_held = course.play(of_held, held, held_drops);
    const std::vector<LandingPeak>& landed = lander.land(drops, course);
    if (course.stopped()) break;
    census.add(first, drops, landed, landed_held);
    course.tell(count + long(held_drops.size()));
  }
  census.finish(out);
  for (const auto& [peak, place] : census.worst())
    out.worst.push_back(
        {drawn ? model.even(1, options.seed, place).front() : options.measured[std::size_t(place)], -peak});
  out.why_none = !drawn                       ? WhyNone::kMeasured
                 : !scatters                  ? WhyNone::kNothingScatters
                 : model.groups().size() == 1 ? WhyNone::kOneGroup
                 : course.stopped()           ? WhyNone::kStopped
                                              : WhyNone::kThere;
  if (out.why_none == WhyNone::kThere) add_indices(out, model, plan, planned, options, course);
  return out;
}

}  // namespace ukemi::landing

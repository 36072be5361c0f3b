#include "landing/judge/risk_run.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "landing/body/load.hpp"
#include "landing/lanes/body_batch.hpp"
#include "landing/scatter/sobol.hpp"

namespace ukemi::landing {

namespace {

constexpr double kAccuracy = 1e-6;  // of a landing's steps; at 1e-5 one peak in a hundred is off by up to 4e-3
constexpr long kChunk = 2048;       // landings that are held in memory at once

/// The peak, infinite where the landing could not be followed.
double peak_of(const RiskRun& run, const BodyLanding& l) {
  const bool flight = l.end == End::kTimeLimit && !std::isfinite(l.contacts.first());
  return no_landing(l.end) || (flight && !run.flight_counts) ? std::numeric_limits<double>::infinity() : l.peak;
}

/// Landings of a run, and their progress.
class DropRunner {
 public:
  DropRunner(const RiskRun& run, long planned) : run_(run), planned_(planned) {}
  /// Later landings, too, are cut off.
  bool stopped() const { return run_.monitor.stopped(); }
  void played(long landings) { run_.monitor.progress(played_ += landings, planned_); }
  std::vector<BodyLanding> play(std::span<const PlayableDrop> drops, BodyMotion PlayableDrop::*motion) const {
    std::vector<BodyBatchCase> cases;
    cases.reserve(drops.size());
    for (const PlayableDrop& d : drops) cases.push_back({&d.scene, &(d.*motion)});
    std::vector<BodyLanding> out(drops.size());
    body_batch_peaks(cases, out, {.accuracy = kAccuracy, .over = &over_}, run_.threads);
    return out;
  }

 private:
  const RiskRun& run_;
  const std::function<bool()> over_ = [this] { return stopped(); };
  long planned_, played_ = 0;
};

/// Counts the results of drops.
class Census {
 public:
  explicit Census(const RiskRun& run) : run_(run), events_(run.events) {}

  void add_held(const BodyLanding& l) {
    if (add(peak_of(run_, l), held_, held_failed_)) held_lost_ += l.joint_lost;
  }
  void add(long index, const PlayableDrop& drop, const BodyLanding& l) {
    from_floor_ += drop.from_floor;
    if (!add(peak_of(run_, l), peaks_, failed_)) return;
    lost_ += l.joint_lost;
    worst_.emplace_back(l.peak, index);
    ++contacts_[{l.peak_contact + 1, l.peak_contact < 0 ? -1 : l.contacts[l.peak_contact]}];
    const std::vector<LoadPeak> loads = loads_of(drop.scene, l);
    bool broken = false;
    for (std::size_t k = 0; k < loads.size(); ++k) {
      const bool occurs = loads[k].value > rating_limit(run_.loads[k], run_.robot);
      events_[k].drops += occurs, broken = broken || (occurs && run_.loads[k].limit);
    }
    broken_ += broken;
  }
  /// Keeps the worst drops; of equal peaks the first is first.
  void sort_worst() {
    const auto kept = std::min(worst_.size(), std::size_t(Risk::kWorst));
    std::partial_sort(worst_.begin(), worst_.begin() + long(kept), worst_.end(),
                      [](auto& a, auto& b) { return std::pair(-a.first, a.second) < std::pair(-b.first, b.second); });
    worst_.resize(kept);
  }
  std::vector<std::pair<double, long>> report(PeakRisk& out) const {
    out.peaks = distribution(peaks_), out.held = distribution(held_);
    out.failed = failed_, out.held_failed = held_failed_;
    out.lost = lost_, out.held_lost = held_lost_, out.from_floor = from_floor_, out.broken = broken_;
    for (const auto& [contact, drops] : contacts_) out.contacts.push_back({contact.first, contact.second, drops});
    std::stable_sort(out.contacts.begin(), out.contacts.end(), [](auto& a, auto& b) { return a.drops > b.drops; });
    out.events = events_;
    out.histogram = histogram(peaks_, held_, out.peaks.q99.value);
    return worst_;
  }

 private:
  /// Whether the peak is one: the drop could be followed.
  static bool add(double peak, std::vector<double>& peaks, long& failed) {
    const bool followed = std::isfinite(peak);
    if (followed)
      peaks.push_back(peak);
    else
      ++failed;
    return followed;
  }

  const RiskRun& run_;
  std::vector<RiskEvent> events_;
  std::vector<double> peaks_, held_;
  std::vector<std::pair<double, long>> worst_;    ///< peaks and indices
  std::map<std::pair<int, int>, long> contacts_;  ///< drops by number and point of the peak's contact
  long failed_ = 0, held_failed_ = 0, lost_ = 0, held_lost_ = 0, from_floor_ = 0, broken_ = 0;
};

/// Sobol's indices of the groups of a sampler: n base points each of A and B, and for each group those of A with its
/// numbers from B.
class IndexPlan {
 public:
  /// About as many points as samples; none where fewer than two groups scatter.
  IndexPlan(const Sampler& sampler, long samples);
  long landings() const { return n_ * long(blocks()); }
  /// Why there are no indices; `stopped`: the run ended before their start.
  PeakRisk::WhyNone why_none(bool stopped) const;
  /// Peaks of `count` points, infinite where not followed; absent: the run was stopped.
  using Peaks = std::function<std::optional<std::vector<double>>(const std::vector<double>& points, long count)>;
  /// Plays the points, at most `chunk` at once unless there are more groups; sets uncertainties, index_landings and
  /// index_failed.
  void compute(PeakRisk& out, long chunk, std::uint64_t seed, int threads, const Peaks& play) const;

 private:
  std::size_t blocks() const { return sampler_->groups().size() + 2; }
  /// Points of `count` base points, block by block.
  std::vector<double> points(long count, std::uint64_t seed, long first) const;

  const Sampler* sampler_;
  long n_ = 0;
};

IndexPlan::IndexPlan(const Sampler& sampler, long samples) : sampler_(&sampler) {
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

PeakRisk::WhyNone IndexPlan::why_none(bool stopped) const {
  using enum PeakRisk::WhyNone;
  const std::size_t groups = sampler_->groups().size();
  return groups == 0 ? kNothingScatters : groups == 1 ? kOneGroup : stopped ? kStopped : kThere;
}

void IndexPlan::compute(PeakRisk& out, long chunk, std::uint64_t seed, int threads, const Peaks& play) const {
  std::vector<std::vector<double>> values(blocks());
  long failed = 0;
  const long part = std::max(1L, chunk / long(blocks()));
  for (long first = 0; first < n_; first += part) {
    const long count = std::min(part, n_ - first);
    const auto peaks = play(points(count, seed, first), count * long(blocks()));
    if (!peaks) {
      out.why_none = PeakRisk::WhyNone::kStopped;
      return;
    }
    for (std::size_t i = 0; i < peaks->size(); ++i) {
      values[i / std::size_t(count)].push_back((*peaks)[i]);
      failed += !std::isfinite((*peaks)[i]);
    }
  }
  out.index_landings = landings(), out.index_failed = failed;
  const auto indices = sobol_indices(values[0], values[1], std::span(values).subspan(2), seed, threads);
  for (std::size_t g = 0; g < indices.size(); ++g)
    out.uncertainties.push_back({sampler_->groups()[g].name, indices[g]});
  std::stable_sort(out.uncertainties.begin(), out.uncertainties.end(),
                   [](auto& a, auto& b) { return a.index.total.value > b.index.total.value; });
}

}  // namespace

std::vector<std::pair<double, long>> RiskRun::play(PeakRisk& out) const {
  const IndexPlan plan(sampler, drawn ? samples : 0);
  DropRunner runner(*this, samples + held + plan.landings());
  Census census(*this);
  for (long first = 0; first < samples; first += kChunk) {
    std::vector<PlayableDrop> chunk = drops(first, std::min(kChunk, samples - first));
    const auto with_held = std::span(chunk).first(std::size_t(std::clamp(held - first, 0L, long(chunk.size()))));
    const std::vector<BodyLanding> of_held = runner.play(with_held, &PlayableDrop::held);
    for (PlayableDrop& d : chunk) d.scene.loads = loads;
    const std::vector<BodyLanding> of_motion = runner.play(chunk, &PlayableDrop::motion);
    if (runner.stopped()) break;
    for (const BodyLanding& l : of_held) census.add_held(l);
    for (std::size_t i = 0; i < chunk.size(); ++i) census.add(first + long(i), chunk[i], of_motion[i]);
    census.sort_worst();
    runner.played(long(chunk.size() + with_held.size()));
  }
  std::vector<std::pair<double, long>> worst = census.report(out);
  out.why_none = drawn ? plan.why_none(runner.stopped()) : PeakRisk::WhyNone::kMeasured;
  if (out.why_none != PeakRisk::WhyNone::kThere) return worst;
  plan.compute(out, kChunk, seed, threads,
               [&](const std::vector<double>& points, long count) -> std::optional<std::vector<double>> {
                 const std::vector<BodyLanding> landings = runner.play(at(points, count), &PlayableDrop::motion);
                 if (runner.stopped()) return std::nullopt;
                 runner.played(count);
                 std::vector<double> peaks;
                 for (const BodyLanding& l : landings) peaks.push_back(peak_of(*this, l));
                 return peaks;
               });
  return worst;
}

}  // namespace ukemi::landing

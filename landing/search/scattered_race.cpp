// Motions raced over scattered drops: all over a few first, those that may still win over more.
#include <algorithm>
#include <cmath>

#include "landing/search/objective.hpp"

namespace ukemi::landing {

namespace {
/// Drops that have been played when motions are compared; after the last of these, all.
constexpr std::array<std::size_t, kScatteredStages> kStages = {8, 32, 96};
/// A motion is given up where its value over the drops so far is above the bound's by this, and more.
constexpr std::array<double, kScatteredStages> kMean = {1.15, 1.04, 1.02}, kTail = {1.2, 1.08, 1.03};
}  // namespace

struct Objective::Scattered {
  ScatteredLandings landings;
  std::vector<DrivenMotion> plays;
  std::vector<std::size_t> open;      ///< motions that are still played
  std::vector<double> peaks, sorted;  ///< peaks: of motion i over drop k at [i * drops + k]
  /// What good motions are worth over the first drops, in parts of what they are worth over all: few drops are all
  /// milder or all harder than many.
  std::array<double, kScatteredStages> share{1, 1, 1};
};

void Objective::judge_scattered(std::span<Candidate> points) { race_over(points, options_.robust->judging, false); }

void Objective::reserve_scattered(std::size_t motions) {
  scattered_ = std::make_shared<Scattered>();
  Scattered& s = *scattered_;
  const std::size_t drops = options_.robust->drops.size();
  s.landings.reserve(motions * drops), s.peaks.reserve(motions * drops);
  s.plays.reserve(motions), s.open.reserve(motions), s.sorted.reserve(drops);
}

bool Objective::keeps_limits(const Candidate& p) const {
  if (!options_.limits.any()) return true;
  constexpr double kRounding = 1e-9;
  const Robust& robust = *options_.robust;
  const std::size_t fewest =
      robust.judging.empty() ? robust.drops.size() : std::min(robust.drops.size(), robust.judging.size());
  const double drops = double(std::max(fewest, std::size_t(p.played)));
  return double(p.played - p.broken) >= (robust.measure.share() - kRounding) * drops;
}

void Objective::race_over(std::span<Candidate> points, std::span<const ScatteredDrop> drops, bool searching) {
  if (!scattered_) scattered_ = std::make_shared<Scattered>();
  Scattered& s = *scattered_;
  const Robust& robust = *options_.robust;
  const auto& patience = robust.measure.kind == Measure::Kind::kMean ? kMean : kTail;
  const std::size_t n = drops.size();
  s.peaks.assign(points.size() * n, 0.0);
  s.open.clear();
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i].value = 0, points[i].worst = points[i].played = points[i].broken = 0;
    if (const DrivenMotion p = play(points[i]); too_quick(p))
      points[i].value = kNoMotion * (1 + peak_reference_rate(p.motion));
    else
      s.open.push_back(i);
  }
  motions_ += long(points.size());
  const auto value_over = [&](std::size_t i, std::size_t count) {
    s.sorted.assign(s.peaks.begin() + long(i * n), s.peaks.begin() + long(i * n + count));
    return robust.measure.of(s.sorted);
  };
  ScatteredOptions options{
      .accuracy = options_.accuracy, .limits = options_.limits, .threads = options_.threads, .over = &over_};
  // A search does not wait for a landing that chatters, nor does a deadline.
  if (!patient_ && (searching || std::isfinite(deadline)))
    options.too_long = BatchOptions::Long::kFail, options.max_steps = max_steps_;
  for (std::size_t from = 0, stage = 0; from < n && !s.open.empty(); ++stage) {
    const std::size_t to = searching && stage < kStages.size() ? std::min(kStages[stage], n) : n;
    s.plays.clear();
    for (const std::size_t i : s.open) s.plays.push_back(play(points[i]));
    const auto& landings = s.landings.play(s.plays, drops.subspan(from, to - from), options, &space_);
    for (std::size_t m = 0; m < s.open.size(); ++m)
      for (std::size_t k = from; k < to; ++k) {
        const LandingPeak& landing = landings[m * (to - from) + k - from];
        Candidate& p = points[s.open[m]];
        s.peaks[s.open[m] * n + k] = counted(landing, robust.penalty);
        p.played += landing.end != End::kStopped, p.broken += landing.end == End::kBroken;
        work_ += work_of(landing.work), flights_ += landing.end == End::kNoContact;
      }
    landings_ += long(landings.size());
    std::erase_if(s.open, [&](std::size_t i) {
      Candidate& p = points[i];
      const double value = value_over(i, to);
      p.value = std::isfinite(value) ? value : kNoMotion;
      if (!std::isfinite(value)) return true;
      if (to == n) return false;
      const double other = p.early[stage] > 0 ? p.early[stage] : s.share[stage] * p.bound;
      p.early[stage] = value;
      if (p.bound >= kNoMotion || !(value > patience[stage] * other)) return false;
      p.value = std::max(p.value, p.bound * (1 + 1e-9));
      return true;
    });
    from = to;
  }
  if (!searching || n <= kStages.back()) return;
  for (const std::size_t i : s.open)
    if (points[i].value <= points[i].bound)
      for (std::size_t k = 0; k < kStages.size(); ++k)
        s.share[k] += 0.1 * (points[i].early[k] / points[i].value - s.share[k]);
}

}  // namespace ukemi::landing

// Motions raced over scattered drops: all over a few first, the still competitive ones over more.
#include <algorithm>
#include <cmath>

#include "landing/search/two_link_objective.hpp"

namespace ukemi::landing {

namespace {
/// Drops that have been played when motions are compared; after the last stage all are.
constexpr std::array<std::size_t, kScatteredStages> kStageDrops = {8, 32, 96};
/// A motion is abandoned where its value over the drops so far exceeds that of the bound by this factor.
constexpr std::array<double, kScatteredStages> kMean = {1.15, 1.04, 1.02}, kTail = {1.2, 1.08, 1.03};
}  // namespace

struct TwoLinkObjective::Scattered {
  ScatteredLandings landings;
  std::vector<DrivenMotion> plays;
  std::vector<std::size_t> active;    ///< indices of motions not yet abandoned
  std::vector<double> peaks, sorted;  ///< peaks: of motion i in drop k at [i * drops + k]
  /// Running mean, over good motions, of the value over the first drops relative to that over all: the first drops may
  /// be milder or harder than the rest.
  std::array<double, kScatteredStages> stage_ratio{1, 1, 1};
};

void TwoLinkObjective::evaluate_judging(std::span<Candidate> points) { race_over(points, robust_->judging, false); }

void TwoLinkObjective::reserve_scattered(std::size_t motions) {
  scattered_ = std::make_shared<Scattered>();
  Scattered& s = *scattered_;
  const std::size_t drops = robust_->drops.size();
  s.landings.reserve(motions * drops), s.peaks.reserve(motions * drops);
  s.plays.reserve(motions), s.active.reserve(motions), s.sorted.reserve(drops);
}

bool TwoLinkObjective::keeps_limits(const Candidate& p) const {
  if (!limits_.any()) return true;
  constexpr double kRounding = 1e-9;
  const Robust& robust = *robust_;
  const std::size_t fewest =
      robust.judging.empty() ? robust.drops.size() : std::min(robust.drops.size(), robust.judging.size());
  const double drops = double(std::max(fewest, std::size_t(p.played)));
  return double(p.played - p.broken) >= (robust.measure.share() - kRounding) * drops;
}

void TwoLinkObjective::race_over(std::span<Candidate> points, std::span<const ScatteredDrop> drops, bool searching) {
  if (!scattered_) scattered_ = std::make_shared<Scattered>();
  Scattered& s = *scattered_;
  const Robust& robust = *robust_;
  const auto& max_ratio = robust.measure.kind == Measure::Kind::kMean ? kMean : kTail;
  const std::size_t n = drops.size();
  s.peaks.assign(points.size() * n, 0.0);
  s.active.clear();
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i].value = 0, points[i].worst = points[i].played = points[i].broken = 0;
    if (const DrivenMotion p = play(points[i]); too_fast(p))
      points[i].value = kNoMotion * (1 + peak_reference_rate(p.motion));
    else
      s.active.push_back(i);
  }
  motions_ += long(points.size());
  const auto value_over = [&](std::size_t i, std::size_t count) {
    s.sorted.assign(s.peaks.begin() + long(i * n), s.peaks.begin() + long(i * n + count));
    return robust.measure.of(s.sorted);
  };
  ScatteredOptions options{.accuracy = accuracy(), .limits = limits_, .threads = threads(), .over = &over_};
  // In a search, or with a deadline, no landing that chatters without end.
  if (!unlimited_steps_ && (searching || std::isfinite(deadline)))
    options.on_max_steps = BatchOptions::OnMaxSteps::kFail, options.max_steps = max_steps_;
  for (std::size_t from = 0, stage = 0; from < n && !s.active.empty(); ++stage) {
    const std::size_t to = searching && stage < kStageDrops.size() ? std::min(kStageDrops[stage], n) : n;
    s.plays.clear();
    for (const std::size_t i : s.active) s.plays.push_back(play(points[i]));
    const auto& landings = s.landings.play(s.plays, drops.subspan(from, to - from), options, &space_);
    for (std::size_t m = 0; m < s.active.size(); ++m)
      for (std::size_t k = from; k < to; ++k) {
        const LandingPeak& landing = landings[m * (to - from) + k - from];
        Candidate& p = points[s.active[m]];
        s.peaks[s.active[m] * n + k] = counted(landing, robust.penalty);
        p.played += landing.end != End::kStopped, p.broken += landing.end == End::kBroken;
        work_ += work_of(landing.work), flights_ += landing.end == End::kNoContact;
      }
    landings_ += long(landings.size());
    std::erase_if(s.active, [&](std::size_t i) {
      Candidate& p = points[i];
      const double value = value_over(i, to);
      p.value = std::isfinite(value) ? value : kNoMotion;
      if (!std::isfinite(value)) return true;
      if (to == n) return false;
      const double reference = p.stage_values[stage] > 0 ? p.stage_values[stage] : s.stage_ratio[stage] * p.bound;
      p.stage_values[stage] = value;
      if (p.bound >= kNoMotion || !(value > max_ratio[stage] * reference)) return false;
      p.value = std::max(p.value, p.bound * (1 + 1e-9));
      return true;
    });
    from = to;
  }
  if (!searching || n <= kStageDrops.back()) return;
  for (const std::size_t i : s.active)
    if (points[i].value <= points[i].bound)
      for (std::size_t k = 0; k < kStageDrops.size(); ++k)
        s.stage_ratio[k] += 0.1 * (points[i].stage_values[k] / points[i].value - s.stage_ratio[k]);
}

}  // namespace ukemi::landing

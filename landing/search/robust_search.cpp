#include "landing/search/robust_search.hpp"

#include <algorithm>
#include <cmath>

#include "landing/search/population.hpp"

namespace ukemi::landing {

RobustSearch::RobustSearch(const AutoSettings& settings) : set_(settings) {
  generation_.reserve(std::size_t(std::max(kBatch, set_.robust_points)));
  starts_.reserve(std::size_t(set_.robust_starts) + kBatch);
  basins_.reserve(kBasins + 1), best_.reserve(kBasins);
}

void RobustSearch::run(Search& search) {
  search_ = &search;
  random_ = Random(search.seed, 2);
  basins_.clear();
  look_for_basins();
  search_basins();
}

std::size_t RobustSearch::few_drops() const {
  const Robust& robust = *search_->objective().options().robust;
  const double times = robust.measure.kind == Measure::Kind::kMean ? 1 : set_.robust_tail;
  return std::min(robust.drops.size(), std::size_t(set_.robust_few * times));
}

void RobustSearch::look_for_basins() {
  constexpr double kNarrowest = -2, kWidest = -0.7;  // powers of ten, in parts of the cube
  const std::size_t few = few_drops();
  const double until = set_.robust_late + 0.1;
  if (!search_->hints.empty()) close_in({search_->hints[0]}, set_.robust_hint, few, until);
  bool judged = judge_best();
  while (!search_->over() && search_->share() < set_.robust_late) {
    if (basins_.size() > 1 && random_.uniform() < set_.robust_near) {
      const double size = std::pow(10.0, random_.uniform(kNarrowest, kWidest));
      close_in(beside(basins_[low_index(random_, basins_.size())], size, random_), size, few, until);
    } else {
      close_in(scouted(), set_.robust_size, few, until);
    }
    if (!judged) judged = judge_best();
  }
}

/// Over all drops: so that there is an answer beside holding, however early the search ends. False where it is none.
bool RobustSearch::judge_best() {
  if (basins_.empty() || search_->over()) return false;
  Candidate best = basins_[0];
  best.bound = kNoMotion;
  search_->evaluate({&best, 1});
  return best.value < kNoMotion;
}

/// Over all drops: the best basins compared, two runs in the best two, then beside the best.
void RobustSearch::search_basins() {
  constexpr double kNarrowest = -3, kWidest = -1.3;
  constexpr std::size_t kRuns = 2;
  const std::size_t all = search_->objective().options().robust->drops.size();
  best_.clear();
  for (std::size_t i = 0; i < std::min(basins_.size(), std::size_t(set_.robust_basins)) && !search_->over(); ++i) {
    Candidate& p = best_.emplace_back(basins_[i]);
    p.bound = kNoMotion;
    search_->evaluate_over({&p, 1}, all);
  }
  std::sort(best_.begin(), best_.end());
  basins_ = best_;
  for (std::size_t i = 0; !search_->over() && !basins_.empty(); ++i) {
    if (i < std::min(best_.size(), kRuns))
      close_in(best_[i], set_.robust_fine, all, 1);
    else
      close_in(basins_[0], std::pow(10.0, random_.uniform(kNarrowest, kWidest)), all, 1);
  }
}

/// The best over a few drops of those that are the best of many by the planned drop.
Candidate RobustSearch::scouted() {
  const auto most = std::size_t(set_.robust_starts);
  starts_.clear();
  const double enough = search_->share() + set_.robust_scouting;
  for (int n = 0; n < set_.robust_scouts && search_->share() < enough && !search_->over(); n += int(kBatch)) {
    const double bound = starts_.size() < most ? kNoMotion : starts_.back().value;
    generation_.assign(kBatch, search_->nothing());
    for (Candidate& p : generation_) p = random_point(random_, search_->dimension()), p.bound = bound;
    search_->evaluate(generation_, Goal::kPeak);
    for (const Candidate& p : generation_)
      if (p.value <= bound && p.value < kNoMotion) starts_.push_back(p);
    std::sort(starts_.begin(), starts_.end());
    starts_.resize(std::min(starts_.size(), most));
  }
  for (Candidate& p : starts_) p.bound = kNoMotion;
  search_->evaluate_over(starts_, few_drops());
  const auto best = std::min_element(starts_.begin(), starts_.end());
  return best == starts_.end() ? search_->nothing() : *best;
}

/// A run's best is so much worse than the best that is known that it is not worth its time; the longer it runs, the
/// less it may be.
bool RobustSearch::behind(double value, int generation) const {
  constexpr int kFree = 6;
  return !basins_.empty() && generation > kFree &&
         value > basins_[0].value * (1 + set_.robust_behind * std::pow(set_.robust_patience, generation - kFree));
}

void RobustSearch::know(const Candidate& p) {
  constexpr double kApart = 0.05;
  if (!(p.value < kNoMotion)) return;
  const auto near =
      std::find_if(basins_.begin(), basins_.end(), [&](const Candidate& b) { return distance(b, p) < kApart; });
  if (near == basins_.end())
    basins_.push_back(p);
  else if (p < *near)
    *near = p;
  std::sort(basins_.begin(), basins_.end());
  if (basins_.size() > kBasins) basins_.pop_back();
}

void RobustSearch::close_in(const Candidate& start, double size, std::size_t drops, double until) {
  constexpr double kBetter = 1e-3, kConverged = 2e-3;
  constexpr int kStalled = 8;
  const auto points = std::size_t(set_.robust_points);
  distribution_.start(start.u, size, int(points));
  Candidate best = search_->nothing(), middle = best;  // of the last generation: what is worse teaches nothing
  double milestone = kNoMotion;
  for (int n = 0, stalled = 0; !search_->over() && (n == 0 || search_->share() < until); ++n) {
    generation_.assign(points, search_->nothing());
    distribution_.sample(random_, generation_);
    if (n == 0) generation_[0].u = start.u;
    for (Candidate& p : generation_) p.bound = middle.value, p.early = middle.early;
    search_->evaluate_over(generation_, drops);
    std::sort(generation_.begin(), generation_.end());
    if (generation_[0] < best) best = generation_[0];
    distribution_.learn(generation_);
    middle = generation_[points / 2];
    const bool better = best.value < milestone * (1 - kBetter);
    if (better) milestone = best.value;
    stalled = better ? 0 : stalled + 1;
    if (stalled > kStalled || distribution_.widest() < kConverged || behind(best.value, n)) break;
  }
  know(best);
}

}  // namespace ukemi::landing

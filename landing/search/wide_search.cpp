#include "landing/search/wide_search.hpp"

#include <algorithm>
#include <cmath>

#include "landing/search/population.hpp"

namespace ukemi::landing {

namespace {
constexpr std::size_t kStarts = 24;
constexpr double kStartsApart = 0.15, kBasinsApart = 0.02;  // in parts of the box
}  // namespace

WideSearch::WideSearch(const AutoSettings& settings) : set_(settings) {
  generation_.reserve(std::size_t(std::max(kBatch, set_.wide_points)));
  starts_.reserve(kStarts + 1), basins_.reserve(kBasins + 1), kept_.reserve(kBasins + 1);
}

void WideSearch::begin(Search& search) {
  search_ = &search;
  goal_ = search.objective().options().goal, until_ = 1;
  random_ = Random(search.seed, 1);
  starts_.clear(), basins_.clear();
}

void WideSearch::know(const Candidate& p) {
  if (p.value < kNoMotion) keep(basins_, kBasins, kBasinsApart, p);
}

void WideSearch::scout_first() {
  Candidate middle = search_->nothing();
  search_->evaluate({&middle, 1});  // so that there is an answer where there is time for one motion
  know(middle);
  if (goal_ == Goal::kTolerant) return screen();
  scout(set_.wide_scouts);
  if (!starts_.empty()) close_in(Candidate(starts_[0]), set_.wide_size);
}

void WideSearch::screen() {
  constexpr std::size_t kRuns = 2;
  constexpr double kNarrow = 0.01, kScouting = 0.5;  // kScouting: of the screening
  kept_ = basins_;
  basins_.clear();
  goal_ = Goal::kPeak;
  until_ = kScouting * set_.wide_screen;
  scout(set_.wide_scouts);
  until_ = set_.wide_screen;
  if (!starts_.empty()) close_in(Candidate(starts_[0]), set_.wide_size);
  while (!over()) run_once();
  goal_ = Goal::kTolerant, until_ = 1;
  generation_ = basins_;
  basins_ = kept_;
  for (Candidate& p : generation_) p.bound = kNoMotion;
  search_->evaluate(generation_);
  for (const Candidate& p : generation_) know(p);
  kept_ = basins_;
  for (std::size_t i = 0; i < std::min(kRuns, kept_.size()) && !search_->over(); ++i) close_in(kept_[i], kNarrow);
}

/// The lowest value so far of what runs go by.
double WideSearch::best_known() const {
  if (goal_ == search_->objective().options().goal) return search_->best().value;
  return basins_.empty() ? kNoMotion : basins_[0].value;
}

void WideSearch::run_once() {
  if (!basins_.empty() && random_.uniform() < set_.wide_near)
    start_beside_a_basin();
  else
    start_anywhere();
}

/// Motions from anywhere; the best that are apart are starts.
void WideSearch::scout(int motions) {
  starts_.clear();
  for (int n = 0; n < motions && !over(); n += kBatch) {
    generation_.assign(std::size_t(std::min(kBatch, motions - n)), search_->nothing());
    for (Candidate& p : generation_) {
      p = point_of(random_, search_->objective().space(), set_.wide_plain);
      p.bound = starts_.size() < kStarts ? kNoMotion : starts_.back().value;
    }
    search_->evaluate(generation_, Goal::kPeak);
    for (const Candidate& p : generation_)
      if (p.value <= p.bound && p.value < kNoMotion) keep(starts_, kStarts, kStartsApart, p);
  }
}

/// Takes a point among the best, in place of the one it is near.
void WideSearch::keep(std::vector<Candidate>& best, std::size_t most, double apart, const Candidate& p) {
  const auto near = std::find_if(best.begin(), best.end(), [&](const Candidate& b) { return distance(b, p) < apart; });
  if (near == best.end())
    best.push_back(p);
  else if (p < *near)
    *near = p;
  std::sort(best.begin(), best.end());
  if (best.size() > most) best.pop_back();
}

void WideSearch::start_anywhere() {
  scout(set_.wide_race);
  if (!starts_.empty()) close_in(Candidate(starts_[0]), set_.wide_size);
}

void WideSearch::start_beside_a_basin() {
  constexpr double kNarrowest = -2, kWidest = -0.7;  // powers of ten, in parts of the box
  const Candidate& basin = basins_[low_index(random_, basins_.size())];
  const double size = std::pow(10.0, random_.uniform(kNarrowest, kWidest));
  close_in(beside(basin, size, random_), size);
}

/// A run's best is so much worse than the best of all that it is not worth its time; the longer it runs, the less it
/// may be.
bool WideSearch::behind(double value, int generation) const {
  constexpr int kFree = 8;  // generations that every run has
  return generation > kFree &&
         value > best_known() * (1 + (set_.wide_behind - 1) * std::pow(set_.wide_patience, generation - kFree));
}

void WideSearch::close_in(const Candidate& start, double size) {
  constexpr double kBetter = 1e-4, kContender = 1.005;
  const auto points = std::size_t(set_.wide_points);
  const int most_stalled = 12 + 3 * search_->dimension();
  distribution_.start(start.u, size, set_.wide_points);
  Candidate best = search_->nothing();
  best.u = start.u;
  double bound = kNoMotion, milestone = kNoMotion;
  for (int n = 0, stalled = 0; !over(); ++n) {
    generation_.assign(points, search_->nothing());
    distribution_.sample(random_, generation_);
    for (Candidate& p : generation_) p.bound = bound;
    search_->evaluate(generation_, goal_);
    std::sort(generation_.begin(), generation_.end());
    const double middle = generation_[points / 2].value;
    bound = middle < kNoMotion ? set_.wide_bound * middle : kNoMotion;
    if (generation_[0] < best) best = generation_[0];
    distribution_.learn(generation_);
    const bool better = best.value < milestone * (1 - kBetter);
    if (better) milestone = best.value;
    stalled = better ? 0 : stalled + 1;
    const double converged = best.value > kContender * best_known() ? set_.wide_poor : set_.finest;
    if (stalled > most_stalled || distribution_.widest() < converged || behind(best.value, n)) break;
  }
  know(best);
}

void wide_search(Search& search, const AutoSettings& settings) {
  WideSearch wide(settings);
  wide.begin(search);
  for (wide.scout_first(); !search.over();) wide.run_once();
}

}  // namespace ukemi::landing

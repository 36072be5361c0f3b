#include "landing/auto_search.hpp"

#include "landing/population.hpp"
#include "landing/solvers.hpp"

namespace ukemi::landing {

namespace {

/// Chosen by the mean gap to the best known over seven scenes, ten seeds and 10,000 motions each.
struct Settings {
  int smallest = 12;  ///< the first population; every restart has one more
  int largest = 32;
  int race = 4;    ///< motions that race for a place in it
  int screen = 8;  ///< the same for tolerant peaks, by the peak alone: one landing each
  Differential step{.factor_low = 0.2, .factor_high = 0.8};
  double converged = 1e-4;  ///< side of a population that has found its basin
  double apart = 0.04;      ///< basins are further apart than this
  int trial_period = 12;    ///< generations that every population gets
  double behind = 1.12;     ///< given up where its best is this much worse than the best of all
  double finest = 1e-7;     ///< side where nothing is left to find
  int refinement = 3;  ///< the best basin is searched once more after this many populations, four times as many, ...
  double late = 0.8;   ///< and once more when this share of the budget is spent
};
constexpr Settings kSet;
constexpr int kBatch = 16;
constexpr std::size_t kBasins = 64;

}  // namespace

AutoSearch::AutoSearch() {
  population_.reserve(std::size_t(kSet.largest * (kSet.screen + 1) + kBatch));
  values_.reserve(population_.capacity());
  trials_.reserve(std::size_t(kSet.largest));
  basins_.reserve(kBasins);
}

void AutoSearch::run(Search& search) {
  search_ = &search;
  random_ = Random(search.seed);
  basins_.clear();
  bool last = false;
  for (int n = 1, next_refinement = kSet.refinement; !search.over(); ++n) {
    size_ = std::min(kSet.largest, kSet.smallest + n - 1);
    race();
    converge(kSet.converged, !basins_.empty());
    remember();
    if (!search.over() && (n == next_refinement || (!last && search.share() > kSet.late))) {
      last = search.share() > kSet.late;
      next_refinement *= 4;
      refine();
    }
  }
}

bool AutoSearch::known(const Point3& p) const {
  return std::any_of(basins_.begin(), basins_.end(), [&](const Point3& b) { return distance(b, p) < kSet.apart; });
}

/// Fills the population with the best of a number of random motions.
void AutoSearch::race() {
  const int places = size_;
  const long left = search_->budget().motions - search_->motions();
  const bool tolerant = search_->objective().options().goal == Goal::kTolerant && left > 2 * places * kSet.screen;
  const int entrants = places * (tolerant ? kSet.screen : kSet.race);
  fill(entrants, tolerant ? Goal::kPeak : search_->objective().options().goal, tolerant ? 2 * places : places);
  if (!tolerant) return;
  // The screened ones in their order, each against the worst that still has a place.
  values_.clear();
  for (std::size_t i = 0; i < population_.size() && !search_->over(); i += kBatch) {
    const std::span<Point3> part(population_.data() + i, std::min<std::size_t>(kBatch, population_.size() - i));
    for (Point3& p : part) p.bound = place_value(places), p.worst = 0;
    search_->evaluate(part);
    for (const Point3& p : part) values_.push_back(p.value);
    std::sort(values_.begin(), values_.end());
  }
  keep(places);
}
double AutoSearch::place_value(int places) const {
  return int(values_.size()) >= places ? values_[std::size_t(places - 1)] : kNoMotion;
}
void AutoSearch::keep(int places) {
  std::sort(population_.begin(), population_.end());
  population_.resize(std::min(population_.size(), std::size_t(places)));
}
void AutoSearch::fill(int entrants, Goal goal, int places) {
  population_.clear(), values_.clear();
  while (int(population_.size()) < entrants && !search_->over()) {
    const std::size_t begin = population_.size();
    for (int i = 0; i < kBatch; ++i) {
      Point3 p = random_point(random_);
      for (int n = 0; n < 20 && known(p); ++n) p = random_point(random_);
      p.bound = place_value(places);
      population_.push_back(p);
    }
    const std::span<Point3> fresh(population_.data() + begin, population_.size() - begin);
    search_->evaluate(fresh, goal);
    for (const Point3& p : fresh) values_.push_back(p.value);
    std::sort(values_.begin(), values_.end());
  }
  keep(places);
}

/// Generations until the population is as small as `side`, or has fallen behind.
void AutoSearch::converge(double side, bool may_give_up) {
  if (int(population_.size()) < size_) return;
  trials_.resize(population_.size());
  for (int generation = 0; !search_->over() && spread(population_) > side; ++generation) {
    evolve(*search_, random_, population_, trials_, kSet.step);
    if (!may_give_up || generation < kSet.trial_period) continue;
    const double best = std::min_element(population_.begin(), population_.end())->value;
    const double grace = 1 + (kSet.behind - 1) * std::pow(0.9, generation - kSet.trial_period);
    if (best > search_->best().value * (spread(population_) < 0.1 ? grace : kSet.behind)) return;
  }
}

void AutoSearch::remember() {
  if (population_.empty()) return;
  const Point3& best = *std::min_element(population_.begin(), population_.end());
  const auto same =
      std::find_if(basins_.begin(), basins_.end(), [&](const Point3& b) { return distance(b, best) < kSet.apart; });
  if (same != basins_.end()) {
    if (best < *same) *same = best;
  } else if (basins_.size() < kBasins) {
    basins_.push_back(best);
  }
}

/// A population close by the best of all.
void AutoSearch::refine() {
  population_.resize(std::size_t(size_));
  scatter(search_->best(), random_, population_);
  search_->evaluate(population_);
  converge(kSet.finest, false);
  remember();
}

void auto_search(Search& search) { AutoSearch().run(search); }

}  // namespace ukemi::landing

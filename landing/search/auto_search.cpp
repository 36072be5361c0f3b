#include "landing/search/auto_search.hpp"

#include "landing/search/population.hpp"
#include "landing/search/solvers.hpp"

namespace ukemi::landing {

namespace {

/// Chosen by the gap to the best known: ten scenes, 0.03 to 1 s, five to sixty seeds that no table reports.
struct Settings {
  int leads = 2;                   ///< that scouts follow at once
  double lead_apart = 0.15;        ///< of the box
  int first = 128;                 ///< scouts that go anywhere; of the later ones
  double anywhere = 0.1;           ///< this share does, and
  long early = 1'000;              ///< beyond so many motions
  double later = 0.5;              ///< this share, the others near a lead:
  double near = 0.6, by = 1;       ///< normal, with sizes from 10^-near down to 10^-by at first,
  double at_last = 3;              ///< and down to 10^-at_last when they are spent
  double scouting = 0.7;           ///< share of the budget that scouts may take once they were
  long few = 1'500, many = 6'000;  ///< few motions; and how many they may be at most
  int best_scouts = 24;            ///< make the first population,
  double scouts_apart = 0.01;      ///< so far apart
  int smallest = 12;               ///< the first that races; every restart has one more
  int largest = 32;
  int race = 60;            ///< motions that race for a place in it
  double race_share = 0.2;  ///< of the budget that one race may take; the scouts' first:
  double first_share = 0.3;
  int screen = 300;         ///< the same for tolerant peaks, by the peak alone: one landing each
  double converged = 1e-4;  ///< side of a population that has found its basin
  double apart = 0.04;      ///< basins are further apart than this
  int trial_period = 12;    ///< generations that every population gets
  double behind = 1.12;     ///< given up where its best is this much worse than the best of all
  double finest = 1e-7;     ///< side where nothing is left to find
  int global = 3;           ///< populations that start anywhere; of the later ones
  double close = 0.5;       ///< this share starts in a box about a basin, of
  double side = 0.15;       ///< this side; it is one of those within
  double nearly = 1.06;     ///< this of the best
  int refinement = 3;  ///< the best basin is searched once more after this many populations, four times as many, ...
  double late = 0.7;   ///< and once more when this share of the budget is spent
};
constexpr Settings kSet;
constexpr int kBatch = 16;
constexpr std::size_t kBasins = 64;

}  // namespace

AutoSearch::AutoSearch() {
  population_.reserve(std::size_t(2 * kSet.largest + kBatch));
  static_assert(kSet.best_scouts <= kSet.largest);
  trials_.reserve(population_.capacity());
  basins_.reserve(kBasins);
  leads_.reserve(std::size_t(kSet.leads));
}

void AutoSearch::run(Search& search) {
  search_ = &search;
  random_ = Random(search.seed);
  basins_.clear();
  choose_region(0);
  refined_last_ = false;
  scout();
  size_ = int(population_.size());
  converge(kSet.converged, false);
  remember();
  for (int n = 1, next_refinement = kSet.refinement; !search.over(); ++n) {
    size_ = std::min(kSet.largest, kSet.smallest + n - 1);
    choose_region(n);
    race(kSet.race_share);
    converge(kSet.converged, true);
    remember();
    if (!search.over() && (n == next_refinement || ending())) {
      refined_last_ = search.share() > kSet.late;
      next_refinement *= 4;
      refine();
    }
  }
}

/// The quickest way down from nothing, and all there is time for in a hundredth of a second: motions from anywhere and
/// from near the leads, each followed only while it may better one. Leaves the best of them as a population.
void AutoSearch::scout() {
  leads_.clear();
  int n = 0;
  if (search_->objective().options().goal == Goal::kTolerant) {
    size_ = kSet.leads;
    race(kSet.first_share);
    for (const Point3& p : population_) lead(p);
    n = kSet.first;
  }
  population_.clear();
  const auto enough = [&] {
    const long done = search_->motions();
    return done >= kSet.many || (done >= kSet.few && search_->share() >= kSet.scouting);
  };
  for (std::array<Point3, kBatch> scouts; !search_->over() && !enough(); n += kBatch) {
    const double spent = std::clamp(double(search_->motions()) / double(kSet.many), search_->share(), 1.0),
                 by = kSet.by + (kSet.at_last - kSet.by) * spent,
                 anywhere = search_->motions() < kSet.early ? kSet.anywhere : kSet.later;
    for (Point3& p : scouts) {
      const bool full = int(leads_.size()) == kSet.leads;
      if (n < kSet.first || leads_.empty() || random_.uniform() < anywhere) {
        p = random_point(random_);
        p.bound = full ? leads_.back().value : kNoMotion;
      } else {  // the better a lead, the more follow it
        const Point3& l = leads_[low_index(random_, leads_.size())];
        p = beside(l, std::pow(10.0, -random_.uniform(kSet.near, by)), random_);
        p.bound = l.value;
      }
    }
    search_->evaluate(scouts);
    for (const Point3& p : scouts)
      if (p.value <= p.bound) lead(p), take(population_, kSet.best_scouts, kSet.scouts_apart, p);
  }
}

void AutoSearch::lead(const Point3& p) { take(leads_, kSet.leads, kSet.lead_apart, p); }

/// Takes a motion among the best: in place of the one it is near, else of the worst of so many, if it is better.
void AutoSearch::take(std::vector<Point3>& best, int most, double apart, const Point3& p) {
  auto place = std::find_if(best.begin(), best.end(), [&](const Point3& b) { return distance(b, p) < apart; });
  if (place == best.end() && int(best.size()) < most)
    best.push_back(p);
  else if (place = place == best.end() ? place - 1 : place; p < *place)
    *place = p;
  std::sort(best.begin(), best.end());
}

/// The basin that a point lies in; none: the end.
std::vector<Point3>::iterator AutoSearch::basin_of(const Point3& p) {
  return std::find_if(basins_.begin(), basins_.end(), [&](const Point3& b) { return distance(b, p) < kSet.apart; });
}

/// Where the n-th population starts: anywhere, or about one of the best basins, the better the more often. A crack too
/// thin for a race over the whole box is found in a race beside it.
void AutoSearch::choose_region(int n) {
  centre_.u = {0.5, 0.5, 0.5}, side_ = 1;
  if (n <= kSet.global || basins_.empty() || random_.uniform() >= kSet.close) return;
  const auto good = std::count_if(basins_.begin(), basins_.end(),
                                  [&](const Point3& b) { return b.value < kSet.nearly * search_->best().value; });
  centre_ = basins_[low_index(random_, std::size_t(good))], side_ = kSet.side;
}

/// A motion of the region, away from the known basins.
Point3 AutoSearch::fresh() {
  Point3 p;
  for (int attempt = 0; attempt <= 20; ++attempt) {
    for (std::size_t k = 0; k < p.u.size(); ++k)
      p.u[k] = std::clamp(centre_.u[k] + side_ * (random_.uniform() - 0.5), 0.0, 1.0);
    if (basin_of(p) == basins_.end()) break;
  }
  return p;
}

/// The best of many motions of the region, each followed only while it may be one of them; at most that share of the
/// budget.
void AutoSearch::race(double share) {
  const Goal goal = search_->objective().options().goal;
  const long left = search_->budget().motions - search_->motions();
  population_.clear();
  if (goal == Goal::kPeak || left < 4 * size_ * kSet.screen) {
    fill(size_ * kSet.race, goal, size_, share);
    return;
  }
  // Tolerant peaks: by the peak alone first; then those that it lets through, in its order.
  fill(size_ * kSet.screen, Goal::kPeak, 2 * size_, share);
  std::swap(population_, trials_);
  population_.clear();
  for (std::size_t i = 0; i < trials_.size() && !search_->over(); i += kBatch) {
    const auto part = std::span(trials_).subspan(i, std::min<std::size_t>(kBatch, trials_.size() - i));
    enter(part, goal, size_);
  }
}

/// Fresh motions for `places` places.
void AutoSearch::fill(int entrants, Goal goal, int places, double share) {
  const double enough = search_->share() + share;
  for (int n = 0; n < entrants && !search_->over(); n += kBatch) {
    if (search_->share() > enough && int(population_.size()) >= places) return;
    std::array<Point3, kBatch> entering;
    for (Point3& p : entering) p = fresh();
    enter(entering, goal, places);
  }
}

/// Gives the points a place in the population where they are good enough.
void AutoSearch::enter(std::span<Point3> points, Goal goal, int places) {
  const double last = int(population_.size()) >= places ? population_[std::size_t(places - 1)].value : kNoMotion;
  for (Point3& p : points) p.bound = last, p.worst = 0;
  search_->evaluate(points, goal);
  population_.insert(population_.end(), points.begin(), points.end());
  std::sort(population_.begin(), population_.end());
  population_.resize(std::min(population_.size(), std::size_t(places)));
}

/// The time has come for the best basin's last refinement.
bool AutoSearch::ending() const { return !refined_last_ && search_->share() > kSet.late; }

/// Generations until the population is as small as `side`, or is given up: behind the best, in a basin that is known,
/// or in the way of the last refinement.
void AutoSearch::converge(double side, bool may_give_up) {
  constexpr int kFewest = 6;
  if (int(population_.size()) < std::max(size_, kFewest)) return;
  trials_.resize(population_.size());
  for (int generation = 0; !search_->over() && spread(population_) > side; ++generation) {
    evolve([this](std::span<Point3> p) { search_->evaluate(p); }, random_, population_, trials_, {});
    if (!may_give_up) continue;
    const Point3& best = *std::min_element(population_.begin(), population_.end());
    if (ending() && best.value > search_->best().value) return;
    if (generation < kSet.trial_period) continue;
    const bool gathered = spread(population_) < 0.1;
    const double grace = 1 + (kSet.behind - 1) * std::pow(0.9, generation - kSet.trial_period);
    if (best.value > search_->best().value * (gathered ? grace : kSet.behind)) return;
    if (const auto b = basin_of(best); gathered && b != basins_.end() && b->value <= best.value) return;
  }
}

void AutoSearch::remember() {
  if (population_.empty()) return;
  const Point3& best = *std::min_element(population_.begin(), population_.end());
  if (const auto same = basin_of(best); same != basins_.end()) {
    if (best < *same) *same = best;
  } else if (basins_.size() < kBasins) {
    basins_.push_back(best);
  }
  std::sort(basins_.begin(), basins_.end());
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

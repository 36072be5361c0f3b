#include "landing/search/auto_search.hpp"

#include "landing/search/population.hpp"
#include "landing/search/robust_search.hpp"
#include "landing/search/solvers.hpp"
#include "landing/search/wide_search.hpp"

namespace ukemi::landing {

AutoSearch::AutoSearch(const AutoSettings& settings)
    : set_(settings), robust_(std::make_unique<RobustSearch>(settings)), wide_(std::make_unique<WideSearch>(settings)) {
  set_.validate();
  population_.reserve(std::size_t(2 * set_.largest + set_.batch));
  trials_.reserve(population_.capacity());
  basins_.reserve(std::size_t(set_.basins));
  leads_.reserve(std::size_t(set_.leads));
  batch_.resize(std::size_t(set_.batch));
}

AutoSearch::~AutoSearch() = default;

void AutoSearch::run(Search& search) {
  search_ = &search;
  random_ = Random(search.seed);
  basins_.clear();
  choose_region(0);
  refined_last_ = false;
  if (search.objective().options().goal == Goal::kRobust) return robust_->run(search);
  const bool wide = search.dimension() > kPaperVariables;
  const bool screens = wide && search.objective().options().goal == Goal::kTolerant;  // by the peak, for itself
  if (!screens) {
    scout();
  } else {
    population_.clear();
    for (const Coordinates& u : search.hints) search.evaluate({&population_.emplace_back(Candidate{u}), 1});
  }
  if (wide) {
    wide_->begin(search);
    for (const Candidate& p : population_) wide_->know(p);
    if (screens) wide_->scout_first();
    while (!search.over()) wide_->run_once();
    return;
  }
  size_ = int(population_.size());
  converge(set_.converged, false);
  remember();
  for (int n = 1, next_refinement = set_.refinement; !search.over(); ++n) {
    size_ = std::min(set_.largest, set_.smallest + n - 1);
    choose_region(n);
    race(set_.race_share);
    converge(set_.converged, true);
    remember();
    if (!search.over() && (n == next_refinement || ending())) {
      refined_last_ = search.share() > set_.late;
      next_refinement *= 4;
      refine();
    }
  }
}

/// A few generations about each place that was given, the best of which leads. What was planned for a drop nearby may
/// be in the right basin though its own value has gone over a cliff.
void AutoSearch::follow_hints() {
  constexpr int kGenerations = 8;
  constexpr std::size_t kSize = 10;
  constexpr double kNear = 0.03;  // of the box
  constexpr double kShare = 0.4;  // of the search
  const std::span<const Coordinates> hints = search_->hints;
  population_.clear();
  for (const Coordinates& u : hints) population_.push_back({u});
  search_->evaluate(population_);
  for (const Candidate& p : population_)
    if (p.value < kNoMotion) lead(p);
  for (std::size_t k = 0; hints.size() > 1 && k < hints.size() && search_->share() < kShare; ++k) {
    population_.assign(kSize, Candidate{hints[k]});
    for (std::size_t i = 1; i < kSize; ++i) population_[i] = beside(population_[0], kNear, random_);
    search_->evaluate(population_);
    trials_.resize(kSize);
    for (int g = 0; g < kGenerations && !search_->over(); ++g)
      evolve([this](std::span<Candidate> p) { search_->evaluate(p); }, random_, population_, trials_, {});
    if (const Candidate& best = *std::min_element(population_.begin(), population_.end()); best.value < kNoMotion)
      lead(best);
  }
}

/// The quickest way down from nothing, and all there is time for in a hundredth of a second: motions from anywhere and
/// from near the leads, each followed only while it may better one. Leaves the best of them as a population.
void AutoSearch::scout() {
  leads_.clear();
  follow_hints();
  const std::optional<Candidate> led = leads_.empty() ? std::nullopt : std::optional(leads_[0]);
  int n = 0;
  if (search_->objective().options().goal == Goal::kTolerant) {
    size_ = set_.leads;
    race(set_.first_share);
    for (const Candidate& p : population_) lead(p);
    n = set_.first;
  }
  population_.clear();
  if (led) population_.push_back(*led);
  const long most = search_->dimension() > kPaperVariables ? set_.wide_scouts : set_.many;
  const auto enough = [&] {
    const long done = search_->motions();
    return done >= most || (done >= set_.few && search_->share() >= set_.scouting);
  };
  for (; !search_->over() && !enough(); n += set_.batch) {
    const double spent = std::clamp(double(search_->motions()) / double(most), search_->share(), 1.0),
                 by = set_.by + (set_.at_last - set_.by) * spent,
                 anywhere = search_->motions() < set_.early ? set_.anywhere : set_.later;
    for (Candidate& p : batch_) {
      const bool full = int(leads_.size()) == set_.leads;
      if (n < set_.first || leads_.empty() || random_.uniform() < anywhere) {
        p = point_of(random_, search_->objective().space(), set_.wide_plain);
        p.bound = full ? leads_.back().value : kNoMotion;
      } else {  // the better a lead, the more follow it
        const Candidate& l = leads_[low_index(random_, leads_.size())];
        p = beside(l, std::pow(10.0, -random_.uniform(set_.near, by)), random_);
        p.bound = l.value;
      }
    }
    search_->evaluate(batch_);
    for (const Candidate& p : batch_)
      if (p.value <= p.bound) lead(p), take(population_, set_.best_scouts, set_.scouts_apart, p);
  }
}

void AutoSearch::lead(const Candidate& p) { take(leads_, set_.leads, set_.lead_apart, p); }

/// Takes a motion among the best: in place of the one it is near, else of the worst of so many, if it is better.
void AutoSearch::take(std::vector<Candidate>& best, int most, double apart, const Candidate& p) {
  auto place = std::find_if(best.begin(), best.end(), [&](const Candidate& b) { return distance(b, p) < apart; });
  if (place == best.end() && int(best.size()) < most)
    best.push_back(p);
  else if (place = place == best.end() ? place - 1 : place; p < *place)
    *place = p;
  std::sort(best.begin(), best.end());
}

/// The basin that a point lies in; none: the end.
std::vector<Candidate>::iterator AutoSearch::basin_of(const Candidate& p) {
  return std::find_if(basins_.begin(), basins_.end(), [&](const Candidate& b) { return distance(b, p) < set_.apart; });
}

/// Where the n-th population starts: anywhere, or about one of the best basins, the better the more often. A crack too
/// thin for a race over the whole box is found in a race beside it.
void AutoSearch::choose_region(int n) {
  centre_ = search_->nothing(), side_ = 1;
  if (n <= set_.global || basins_.empty() || random_.uniform() >= set_.close) return;
  const auto good = std::count_if(basins_.begin(), basins_.end(),
                                  [&](const Candidate& b) { return b.value < set_.nearly * search_->best().value; });
  centre_ = basins_[low_index(random_, std::size_t(good))], side_ = set_.side;
}

/// A motion of the region, away from the known basins.
Candidate AutoSearch::fresh() {
  Candidate p = search_->nothing();
  for (int attempt = 0; attempt <= 20; ++attempt) {
    for (int k = 0; k < p.u.size(); ++k)
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
  if (goal == Goal::kPeak || left < 4 * size_ * set_.screen) {
    fill(size_ * set_.race, goal, size_, share);
    return;
  }
  // Tolerant peaks: by the peak alone first; then those that it lets through, in its order.
  fill(size_ * set_.screen, Goal::kPeak, 2 * size_, share);
  std::swap(population_, trials_);
  population_.clear();
  for (std::size_t i = 0; i < trials_.size() && !search_->over(); i += batch_.size()) {
    const auto part = std::span(trials_).subspan(i, std::min(batch_.size(), trials_.size() - i));
    enter(part, goal, size_);
  }
}

/// Fresh motions for `places` places.
void AutoSearch::fill(int entrants, Goal goal, int places, double share) {
  const double enough = search_->share() + share;
  for (int n = 0; n < entrants && !search_->over(); n += set_.batch) {
    if (search_->share() > enough && int(population_.size()) >= places) return;
    for (Candidate& p : batch_) p = fresh();
    enter(batch_, goal, places);
  }
}

/// Gives the points a place in the population where they are good enough.
void AutoSearch::enter(std::span<Candidate> points, Goal goal, int places) {
  const double last = int(population_.size()) >= places ? population_[std::size_t(places - 1)].value : kNoMotion;
  for (Candidate& p : points) p.bound = last, p.worst = 0;
  search_->evaluate(points, goal);
  population_.insert(population_.end(), points.begin(), points.end());
  std::sort(population_.begin(), population_.end());
  population_.resize(std::min(population_.size(), std::size_t(places)));
}

/// The time has come for the best basin's last refinement.
bool AutoSearch::ending() const { return !refined_last_ && search_->share() > set_.late; }

/// Generations until the population is as small as `side`, or is given up: behind the best, in a basin that is known,
/// or in the way of the last refinement.
void AutoSearch::converge(double side, bool may_give_up) {
  constexpr int kFewest = 6;
  if (int(population_.size()) < std::max(size_, kFewest)) return;
  trials_.resize(population_.size());
  for (int generation = 0; !search_->over() && spread(population_) > side; ++generation) {
    evolve([this](std::span<Candidate> p) { search_->evaluate(p); }, random_, population_, trials_, {});
    if (!may_give_up) continue;
    const Candidate& best = *std::min_element(population_.begin(), population_.end());
    if (ending() && best.value > search_->best().value) return;
    if (generation < set_.trial_period) continue;
    const bool gathered = spread(population_) < 0.1;
    const double grace = 1 + (set_.behind - 1) * std::pow(0.9, generation - set_.trial_period);
    if (best.value > search_->best().value * (gathered ? grace : set_.behind)) return;
    if (const auto b = basin_of(best); gathered && b != basins_.end() && b->value <= best.value) return;
  }
}

void AutoSearch::remember() {
  if (population_.empty()) return;
  const Candidate& best = *std::min_element(population_.begin(), population_.end());
  if (const auto same = basin_of(best); same != basins_.end()) {
    if (best < *same) *same = best;
  } else if (basins_.size() < std::size_t(set_.basins)) {
    basins_.push_back(best);
  }
  std::sort(basins_.begin(), basins_.end());
}

/// A population close by the best of all.
void AutoSearch::refine() {
  population_.resize(std::size_t(size_));
  scatter(search_->best(), random_, population_);
  search_->evaluate(population_);
  converge(set_.finest, false);
  remember();
}

void auto_search(Search& search, const AutoSettings& settings) { AutoSearch(settings).run(search); }

}  // namespace ukemi::landing

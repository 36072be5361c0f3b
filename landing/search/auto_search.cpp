#include "landing/search/auto_search.hpp"

#include <algorithm>
#include <cmath>

#include "landing/search/cma.hpp"
#include "landing/search/population.hpp"
#include "landing/search/scouts.hpp"
#include "landing/search/solvers.hpp"

namespace ukemi::landing {

namespace {

// Sizes and distances in parts of the cube, shares in parts of the budget. They were tuned on the shipped scenes, with
// seeds from 100 on.
constexpr std::size_t kBasins = 24;
constexpr double kBasinsApart = 0.04, kIncumbentsApart = 0.15;
constexpr double kPlain = 0.1;   // share of the motions from anywhere that do nothing but the quintic, see point_of
constexpr int kGeneration = 16;  // motions
constexpr int kToTheEnd = 1'000'000;  // generations that no run needs

/// Settings of a run that descends by an adapting distribution.
struct Descent {
  double size;             ///< its standard deviation at the start
  double slack, patience;  ///< how much worse than the best a run may be, and its factor after each generation
  double precision;        ///< relative: to better the best by less does not count
  int stalled, each;       ///< generations without, and so many for each variable more, until it ends
  double finest, poor;     ///< its width where it has converged: of the best run, of others
  long scouts;             ///< before a later run: the dearer a run, the more
  std::size_t starts;      ///< of them so many are judged again, the best that lie
  double apart;            ///< so far apart
};
constexpr Descent kSharp{0.03, 0.6, 0.985, 1e-4, 12, 3, 1e-7, 1e-3, 200, 24, 0.15},
    kSmooth{0.08, 0.5, 0.93, 1e-3, 8, 0, 2e-3, 2e-3, 300, AutoSearch::kAtOnce, 0.02};

/// Of runs that minimise `by`: over drops, or of one.
const Descent& descent_of(const Fidelity& by) { return by.goal == Goal::kRobust ? kSmooth : kSharp; }

}  // namespace

GoalProfile profile_of(const Objective::Options& options, double most) {
  constexpr double kMany = 2.5e5;  // with fewer landings the peak does not lead to its best basins, and leaves too few
  const Fidelity peak = Goal::kPeak;
  if (options.goal == Goal::kPeak) return {peak};
  if (options.goal == Goal::kTolerant) return {Goal::kTolerant, {{{peak, 0.5}}}};
  const std::size_t drops = options.robust->measure.kind == Measure::Kind::kMean ? 4 : 8;  // a tail needs more
  const GoalProfile::Stage few{{Goal::kRobust, drops}, most < kMany ? 0.75 : 0.6};
  if (most < kMany) return {Goal::kRobust, {{few}}, 0.2, true, 5};
  return {Goal::kRobust, {{{peak, 0.15}, few}}, 0.2, true};
}

AutoSearch::AutoSearch()
    : distribution_(std::make_unique<CovarianceAdaptation>()),
      starts_(Archive::kMost, 0),
      basins_(kBasins, kBasinsApart),
      judged_(kBasins, kBasinsApart) {
  generation_.reserve(Archive::kMost), population_.reserve(Archive::kMost);
}

AutoSearch::~AutoSearch() = default;

void AutoSearch::run(Search& search) {
  search_ = &search;
  profile_ = profile_of(search.objective().options(), search.most());
  random_ = Random(search.seed);
  races_ = 0;
  basins_.clear();
  by_ = profile_.goal;
  follow_hints();
  judged_ = basins_;  // where the given starting points led
  if (profile_.rougher[0].until > 0) {
    basins_.clear();
    for (const GoalProfile::Stage& stage : profile_.rougher)
      if (stage.until > 0) look_for_basins(stage);
    judge_basins();
  } else {
    until_ = 1;
    run_from_incumbents();
  }
  while (!over()) hop();
}

/// A few generations about each given starting point. What was planned for a drop nearby may be in the right basin
/// though its own value has gone over a cliff.
void AutoSearch::follow_hints() {
  constexpr double kShare = 0.4, kSize = 0.03;
  constexpr int kGenerations = 8;
  until_ = kShare;
  for (const Coordinates& u : search_->hints)
    if (!over()) descend(u, kSize, kGenerations, InKnownBasin::kGoesOn);
}

/// Fast first descent, with or without known basins: motions from anywhere, then most of them from close to
/// the two best, the incumbents, each followed only while it may better one; from the best of them the first run.
void AutoSearch::run_from_incumbents() {
  constexpr long kFree = 128, kEarly = 1'000, kEnough = 1'500, kMany = 6'000;  // motions
  constexpr double kAnywhere = 0.1, kLater = 0.5;                  // share from anywhere, before kEarly, after
  constexpr double kFarthest = -0.6, kNearest = -1, kAtLast = -3;  // powers of ten beside an incumbent
  starts_ = Archive(2, kIncumbentsApart);
  const auto enough = [&] { return search_->motions() >= kEnough && search_->share() >= profile_.scouting; };
  for (const Candidate& b : basins_) starts_.add(b);
  for (long n = starts_.empty() ? 0 : kFree; n < kMany && !over() && !enough(); n += kBatch) {
    const double spent = std::max(double(n) / double(kMany), search_->share()),
                 nearest = kNearest + (kAtLast - kNearest) * spent;
    const double anywhere = n < kFree ? 1 : n < kEarly ? kAnywhere : kLater;
    scout(*search_, random_, {anywhere, nearest, kFarthest, kPlain}, by_, starts_, generation_);
    for (const Candidate& p : generation_)
      if (p.value <= p.bound) basins_.add(p);
  }
  if (starts_.empty()) return;
  if (!by_population())
    return descend(Coordinates(starts_[0].u), descent_of(by_).size, kToTheEnd, InKnownBasin::kGoesOn);
  population_.assign(basins_.begin(), basins_.end());
  basins_.clear();
  converge(false);
}

/// Runs that minimise a rougher value: from where the stage before ended, the best by this one's value first.
void AutoSearch::look_for_basins(const GoalProfile::Stage& stage) {
  constexpr long kScouts = 3'000;
  constexpr std::size_t kCarried = 4;
  constexpr double kSize = 0.03;
  by_ = stage.by, until_ = stage.until;
  if (basins_.empty()) {
    run_from_scouts(kScouts, profile_.scouting * until_, nullptr);
  } else {
    starts_ = basins_;
    basins_.clear();
    judge_starts();
    population_.assign(starts_.begin(), starts_.begin() + std::min(kCarried, starts_.size()));
    for (std::size_t i = 0; i < population_.size() && !over(); ++i)
      descend(Coordinates(population_[i].u), kSize, kToTheEnd, InKnownBasin::kIsGivenUp);
  }
  for (judge_best(); !over(); judge_best()) hop();
}

/// Judges by the goal, so that there is an answer besides holding, however early the search ends.
void AutoSearch::judge_best() {
  if (basins_.empty() || search_->best().value < search_->held().value || search_->over()) return;
  Candidate best = basins_[0];
  best.bound = kNoMotion, best.worst = -1;
  search_->evaluate({&best, 1});
  judged_.add(best);
}

/// The best basins by the goal: compared, then a run in each of the best two, or a population close to them.
void AutoSearch::judge_basins() {
  constexpr double kShare = 0.05, kNarrow = 0.015;
  constexpr std::size_t kLeast = 4, kRuns = 2;
  by_ = profile_.goal, until_ = 1;
  const double enough = search_->share() + kShare;
  for (std::size_t i = 0; i < basins_.size() && !over() && (i < kLeast || search_->share() < enough); ++i) {
    Candidate p = basins_[i];
    if (judged_.beside(p, kNoMotion)) continue;
    p.bound = kNoMotion, p.worst = -1;
    search_->evaluate({&p, 1}, by_);
    judged_.add(p);
  }
  basins_ = judged_;
  if (by_population()) return run_from_incumbents();
  for (std::size_t i = 0; i < std::min(kRuns, judged_.size()) && !over(); ++i)
    descend(judged_[i].u, kNarrow, kToTheEnd, InKnownBasin::kGoesOn);
}

/// A run from close to one of the basins, the better the likelier, or from anywhere.
void AutoSearch::hop() {
  constexpr int kGlobal = 3;                                  // populations from anywhere, first of all
  constexpr double kNear = 0.5, kBox = 0.95, kNearly = 1.06;  // shares; a basin worth a race is this good
  constexpr double kNarrowest = -2, kWidest = -0.7;           // powers of ten
  constexpr double kShare = 0.1, kRaceShare = 0.2;            // of the budget, for scouts at most
  constexpr double kFinest = -3, kFine = -1.3;                // likewise over all drops, which cost the most
  const long scouts = profile_.scouts * descent_of(by_).scouts;
  if (profile_.smooth && search_->objective().exact(by_) && !basins_.empty())
    return descend(Coordinates(basins_[0].u), std::pow(10.0, random_.uniform(kFinest, kFine)), kToTheEnd,
                   InKnownBasin::kGoesOn);
  if (basins_.size() < 2 || (by_population() && races_ < kGlobal) || random_.uniform() >= kNear)
    return run_from_scouts(scouts, by_population() ? kRaceShare : kShare, nullptr);
  if (by_population() && random_.uniform() < kBox) {
    const auto good = std::count_if(basins_.begin(), basins_.end(),
                                    [&](const Candidate& b) { return b.value < kNearly * basins_.lowest(); });
    const Coordinates about = basins_[low_index(random_, std::size_t(good))].u;
    return run_from_scouts(scouts, kRaceShare, &about);
  }
  const double size = std::pow(10.0, random_.uniform(kNarrowest, kWidest));
  descend(beside(basins_[low_index(random_, basins_.size())], size, random_).u, size, kToTheEnd,
          InKnownBasin::kIsGivenUp);
}

/// A run from the best of so many scouts, which take that share of the budget at most: about a place, or anywhere.
void AutoSearch::run_from_scouts(long motions, double share, const Coordinates* about) {
  constexpr std::size_t kSmallest = 12, kLargest = 32;  // populations: every one is larger by one
  constexpr long kRace = 60, kScreen = 300;             // scouts for a place, where they are judged once more
  constexpr double kSame = 1e-5;
  const Descent& descent = descent_of(by_);
  const bool judges = by_.goal != Goal::kPeak;
  const std::size_t places = std::min(kLargest, kSmallest + std::size_t(races_));
  if (by_population()) {
    starts_ = Archive(judges ? 2 * places : places, kSame);
    motions = std::max(motions, long(places) * (judges ? kScreen : kRace));
    ++races_;
  } else {
    starts_ = judges ? Archive(descent.starts, descent.apart) : Archive(2, kIncumbentsApart);
  }
  const double enough = search_->share() + share;
  for (long n = 0; n < motions && !over() && search_->share() < enough; n += kBatch) {
    generation_.assign(kBatch, search_->nothing());
    for (Candidate& p : generation_) p = draw(about), p.bound = starts_.bound();
    race(*search_, Goal::kPeak, starts_, generation_);
  }
  if (judges) judge_starts();
  if (starts_.empty()) return;
  if (!by_population()) return descend(Coordinates(starts_[0].u), descent.size, kToTheEnd, InKnownBasin::kIsGivenUp);
  population_.assign(starts_.begin(), starts_.begin() + std::min(places, starts_.size()));
  converge(true);
}

/// A motion from anywhere, or of a box about a place, away from the known basins.
Candidate AutoSearch::draw(const Coordinates* about) {
  constexpr int kAttempts = 20;
  constexpr double kSide = 0.15;
  Candidate p = search_->nothing();
  for (int n = 0; n < kAttempts; ++n) {
    p = point_of(random_, search_->objective().space().variables(), kPlain);
    if (about) p.u = (*about + kSide * (p.u - Coordinates::Constant(p.u.size(), 0.5))).cwiseMax(0).cwiseMin(1);
    if (!basins_.beside(p, kNoMotion)) break;
  }
  return p;
}

/// The starts again, in the order of the value that runs minimise.
void AutoSearch::judge_starts() {
  generation_.assign(starts_.begin(), starts_.end());
  starts_.clear();
  for (Candidate& p : generation_) p.bound = kNoMotion, p.worst = -1;
  search_->evaluate(generation_, by_);
  for (const Candidate& p : generation_) starts_.add(p);
}

/// A run's best is so much worse than the best basin that it is not worth its time; the longer it runs, the less it may
/// be.
bool AutoSearch::lags(double value, double slack, double patience, int generation) const {
  return value > basins_.lowest() * (1 + slack * std::pow(patience, generation));
}

/// Generations until the population has found its basin, or is given up: worse than the best, or in a known basin.
/// It needs no slope, so kinks and cliffs do not stop it, and its spread follows the valleys.
void AutoSearch::converge(bool may_give_up) {
  constexpr std::size_t kFewest = 6;
  constexpr int kFree = 12;
  constexpr double kConverged = 1e-4, kGathered = 0.1, kSlack = 0.12, kPatience = 0.9;
  if (population_.size() < kFewest) return;
  generation_.assign(population_.size(), search_->nothing());
  const auto best = [this]() -> const Candidate& { return *std::min_element(population_.begin(), population_.end()); };
  for (int n = 0; !over() && spread(population_) > kConverged; ++n) {
    evolve([this](std::span<Candidate> p) { search_->evaluate(p, by_); }, random_, population_, generation_, {});
    if (!may_give_up || n < kFree) continue;
    const bool gathered = spread(population_) < kGathered;
    if (lags(best().value, kSlack, gathered ? kPatience : 1, n - kFree)) break;
    if (gathered && basins_.beside(best(), best().value)) break;
  }
  basins_.add(best());
}

/// A run from a place, of a size in parts of the cube.
void AutoSearch::descend(const Coordinates& start, double size, int generations, InKnownBasin run) {
  constexpr double kBound = 1.2;        // a motion is left where it is worse than the last generation's middle by this
  constexpr double kContender = 1.005;  // a run this close to the best goes on to the finest width
  constexpr int kFree = 8;
  const Descent& how = descent_of(by_);
  const int most_stalled = how.stalled + how.each * search_->dimension();
  distribution_->start(start, size, kGeneration);
  Candidate best = search_->nothing(), middle = best;
  double milestone = kNoMotion;
  for (int n = 0, stalled = 0; n < generations && !over(); ++n) {
    generation_.assign(kGeneration, search_->nothing());
    distribution_->sample(random_, generation_);
    if (n == 0) generation_[0].u = start;
    for (Candidate& p : generation_) p.bound = std::min(kNoMotion, kBound * middle.value), p.early = middle.early;
    search_->evaluate(generation_, by_);
    std::sort(generation_.begin(), generation_.end());
    best = std::min(best, generation_[0]);
    distribution_->learn(generation_);
    middle = generation_[kGeneration / 2];
    const bool better = best.value < milestone * (1 - how.precision);
    if (better) milestone = best.value;
    stalled = better ? 0 : stalled + 1;
    const double converged = best.value > kContender * basins_.lowest() ? how.poor : how.finest;
    if (stalled > most_stalled || distribution_->widest() < converged) break;
    if (run == InKnownBasin::kIsGivenUp && n > kFree && distribution_->widest() < kBasinsApart &&
        basins_.beside(best, best.value))
      return;
    if (n > kFree && lags(best.value, how.slack, how.patience, n - kFree)) break;
  }
  basins_.add(best);
}

void auto_search(Search& search) { AutoSearch().run(search); }

}  // namespace ukemi::landing

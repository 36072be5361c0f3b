#include "landing/search/auto_search.hpp"

#include <algorithm>
#include <cmath>

#include "landing/search/cma.hpp"
#include "landing/search/population.hpp"
#include "landing/search/scouts.hpp"
#include "landing/search/solvers.hpp"

namespace ukemi::landing {

namespace {

// Sizes and distances as fractions of the cube, shares as fractions of the budget; tuned on the shipped scenes with
// seeds from 100 on.
constexpr std::size_t kBasins = 24;
constexpr double kBasinsApart = 0.04, kIncumbentsApart = 0.15;
constexpr double kNeutral = 0.1;       // share of the uniform scouts that are a quintic alone, see random_point
constexpr int kGeneration = 16;        // motions
constexpr int kUnlimited = 1'000'000;  // generations

/// Settings of a run of covariance matrix adaptation.
struct Descent {
  double size;             ///< initial standard deviation
  double slack, patience;  ///< how much worse than the best basin a run may be, relative, and its factor a generation
  double min_gain;         ///< a smaller relative improvement of the best does not count
  int stalled, stalled_per_variable;  ///< generations without improvement until it ends: constant, for each variable
  double finest, coarse;              ///< standard deviation at which it has converged: of the best run, of others
  long scouts;                        ///< before a later run: the more, the more a run costs
  std::size_t starts;                 ///< number of the best scouts that are evaluated again
  double separation;                  ///< minimum distance of these
};
constexpr Descent kSharp{0.03, 0.6, 0.985, 1e-4, 12, 3, 1e-7, 1e-3, 200, 24, 0.15},
    kSmooth{0.08, 0.5, 0.93, 1e-3, 8, 0, 2e-3, 2e-3, 300, AutoSearch::kMaxBatch, 0.02};

/// Settings of runs over drops, or of the planned one.
const Descent& descent_of(const Fidelity& fidelity) { return fidelity.goal == Goal::kRobust ? kSmooth : kSharp; }

}  // namespace

GoalProfile profile_of(const Objective& objective, double budget) {
  constexpr double kLarge = 2.5e5;  // landings; with fewer a stage by the peak costs too much and misses basins
  constexpr long kOfContacts = 4;   // factor of scouts where basins of several first contacts lie far apart
  const Fidelity peak = Goal::kPeak;
  const long factor = objective.several_contacts() ? kOfContacts : 1;
  if (objective.goal() == Goal::kPeak) return {.goal = peak, .scout_factor = factor};
  if (objective.goal() == Goal::kTolerant)
    return {.goal = Goal::kTolerant, .low_fidelity = {{{peak, 0.5}}}, .scout_factor = factor};
  const std::size_t drops = objective.measure()->kind == Measure::Kind::kMean ? 4 : 8;  // of a tail
  const GoalProfile::Stage few_drops{{Goal::kRobust, drops}, budget < kLarge ? 0.75 : 0.6};
  if (budget < kLarge) return {Goal::kRobust, {{few_drops}}, 0.2, true, 5};
  return {Goal::kRobust, {{{peak, 0.15}, few_drops}}, 0.2, true};
}

AutoSearch::AutoSearch()
    : distribution_(std::make_unique<CovarianceAdaptation>()),
      starts_(Archive::kMost, 0),
      basins_(kBasins, kBasinsApart),
      goal_basins_(kBasins, kBasinsApart) {
  generation_.reserve(Archive::kMost), population_.reserve(Archive::kMost);
}

AutoSearch::~AutoSearch() = default;

void AutoSearch::run(Search& search) {
  search_ = &search;
  profile_ = profile_of(search.objective(), search.expected_total());
  random_ = Random(search.seed);
  populations_ = 0;
  refined_ = Coordinates();
  basins_.clear();
  fidelity_ = profile_.goal;
  run_from_warm_starts();
  goal_basins_ = basins_;  // of the warm starts
  if (profile_.low_fidelity[0].end_share > 0) {
    basins_.clear();
    for (const GoalProfile::Stage& stage : profile_.low_fidelity)
      if (stage.end_share > 0) run_stage(stage);
    refine_basins();
  } else {
    end_share_ = 1;
    run_from_incumbents();
  }
  while (!over()) hop();
}

/// A few generations around each warm start: the plan of a similar drop may lie in the right basin though it is now
/// beyond a cliff itself.
void AutoSearch::run_from_warm_starts() {
  constexpr double kShare = 0.4, kSize = 0.03;
  constexpr int kGenerations = 8;
  end_share_ = kShare;
  for (const Coordinates& u : search_->warm_starts)
    if (!over()) descend(u, kSize, kGenerations, OnKnownBasin::kContinue);
}

/// Fast first descent: uniform scouts unless basins are known, then most scouts around the two incumbents, each
/// followed only while it may improve on one; the first run starts from the best of them.
void AutoSearch::run_from_incumbents() {
  constexpr long kUniform = 128, kEarly = 1'000, kFewest = 1'500, kMost = 6'000;  // motions
  constexpr double kEarlyShare = 0.1, kLateShare = 0.5;           // of uniform scouts, before kEarly and after
  constexpr double kFarthest = -0.6, kNearest = -1, kFinal = -3;  // log10 of the distance to an incumbent
  starts_ = Archive(2, kIncumbentsApart);
  const auto enough = [&] { return search_->motions() >= kFewest && search_->share() >= profile_.scout_share; };
  for (const Candidate& b : basins_) starts_.add(b);
  for (long n = starts_.empty() ? 0 : kUniform; n < kMost && !over() && !enough(); n += kBatch) {
    const double spent = std::max(double(n) / double(kMost), search_->share()),
                 nearest = kNearest + (kFinal - kNearest) * spent;
    const double uniform = n < kUniform ? 1 : n < kEarly ? kEarlyShare : kLateShare;
    scout(*search_, random_, {uniform, nearest, kFarthest, kNeutral}, fidelity_, starts_, generation_);
    for (const Candidate& p : generation_)
      if (p.value <= p.bound) basins_.add(p);
  }
  if (starts_.empty()) return;
  if (!uses_population())
    return starts_.for_each_contact([this](const Candidate& start) {
      if (!over()) descend(start.u, descent_of(fidelity_).size, kUnlimited, OnKnownBasin::kContinue);
    });
  population_.assign(basins_.begin(), basins_.end());
  basins_.clear();
  evolve_population(false);
}

/// Runs of a stage of low fidelity, from the basins of the stage before, sorted by their values of this one.
void AutoSearch::run_stage(const GoalProfile::Stage& stage) {
  constexpr long kScouts = 3'000;
  constexpr std::size_t kCarried = 4;
  constexpr double kSize = 0.03;
  fidelity_ = stage.fidelity, end_share_ = stage.end_share;
  if (basins_.empty()) {
    run_from_scouts(kScouts, profile_.scout_share * end_share_, nullptr);
  } else {
    starts_ = basins_;
    basins_.clear();
    reevaluate_starts();
    population_.assign(starts_.begin(), starts_.begin() + std::min(kCarried, starts_.size()));
    for (std::size_t i = 0; i < population_.size() && !over(); ++i)
      descend(Coordinates(population_[i].u), kSize, kUnlimited, OnKnownBasin::kAbandon);
  }
  for (evaluate_best_basin(); !over(); evaluate_best_basin()) hop();
}

/// Evaluates the goal of the best basin: an answer other than holding, however early the search ends.
void AutoSearch::evaluate_best_basin() {
  if (basins_.empty() || search_->best().value < search_->held().value || search_->over()) return;
  Candidate best = basins_[0];
  best.bound = kNoMotion, best.worst = -1;
  search_->evaluate({&best, 1});
  goal_basins_.add(best);
}

/// Evaluates the goal of the best basins; then a run in each of the best two, or a population around them.
void AutoSearch::refine_basins() {
  constexpr double kShare = 0.05, kNarrow = 0.015;
  constexpr std::size_t kLeast = 4, kRuns = 2;
  fidelity_ = profile_.goal, end_share_ = 1;
  for (const Candidate& start : starts_)  // where there was no time for as many runs
    if (basins_.size() < kLeast) basins_.add(start);
  const double enough = search_->share() + kShare;
  for (std::size_t i = 0; i < basins_.size() && !over() && (i < kLeast || search_->share() < enough); ++i) {
    Candidate p = basins_[i];
    if (goal_basins_.beside(p, kNoMotion)) continue;
    p.bound = kNoMotion, p.worst = -1;
    search_->evaluate({&p, 1}, fidelity_);
    goal_basins_.add(p);
  }
  basins_ = goal_basins_;
  if (uses_population()) return run_from_incumbents();
  for (std::size_t i = 0; i < std::min(kRuns, goal_basins_.size()) && !over(); ++i)
    descend(goal_basins_[i].u, kNarrow, kUnlimited, OnKnownBasin::kContinue);
}

/// A run from close to one of the basins, a better one with higher probability, or from uniform scouts.
void AutoSearch::hop() {
  constexpr int kGlobal = 3;                              // first populations, from uniform scouts
  constexpr double kLocal = 0.5, kBox = 0.95;             // probabilities
  constexpr double kGood = 1.06;                          // of the lowest value: worth a population
  constexpr double kNarrowest = -2, kWidest = -0.7;       // log10 of a run's initial size
  constexpr double kFinest = -3, kFine = -1.3;            // the same over all drops, which cost most
  constexpr double kShare = 0.1, kPopulationShare = 0.2;  // of the budget, for scouts at most
  constexpr double kLate = 0.85;                          // of the budget: then the best is refined
  if (search_->share() > kLate && search_->objective().refines() && refine_best()) return;
  const long scouts = profile_.scout_factor * descent_of(fidelity_).scouts;
  if (profile_.smooth && search_->objective().exact(fidelity_) && !basins_.empty())
    return descend(Coordinates(basins_[0].u), std::pow(10.0, random_.uniform(kFinest, kFine)), kUnlimited,
                   OnKnownBasin::kContinue);
  if (basins_.size() < 2 || (uses_population() && populations_ < kGlobal) || random_.uniform() >= kLocal)
    return run_from_scouts(scouts, uses_population() ? kPopulationShare : kShare, nullptr);
  if (uses_population() && random_.uniform() < kBox) {
    const auto good = std::count_if(basins_.begin(), basins_.end(),
                                    [&](const Candidate& b) { return b.value < kGood * basins_.lowest(); });
    const Coordinates centre = basins_[biased_index(random_, std::size_t(good))].u;
    return run_from_scouts(scouts, kPopulationShare, &centre);
  }
  const double size = std::pow(10.0, random_.uniform(kNarrowest, kWidest));
  descend(perturbed(basins_.draw(random_), size, random_).u, size, kUnlimited, OnKnownBasin::kAbandon);
}

/// Descends from the best, by derivatives where there are some, then narrowly; false where that has been done.
bool AutoSearch::refine_best() {
  constexpr double kSize = 0.01;
  const Candidate best = search_->best();
  const bool done = refined_.size() == best.u.size() && best.u == refined_;
  if (!(best.value < kNoMotion) || done) return false;
  if (search_->objective().gradient_rows(fidelity_) > 0) descend_by_gradient(*search_, fidelity_, best);
  descend(Coordinates(search_->best().u), kSize, kUnlimited, OnKnownBasin::kContinue);
  refined_ = search_->best().u;
  return true;
}

/// A run from the best of `motions` scouts around `centre` or uniform ones, at most `share` of the budget.
void AutoSearch::run_from_scouts(long motions, double share, const Coordinates* centre) {
  constexpr std::size_t kSmallest = 12, kLargest = 32;  // members; each population has one more
  constexpr long kPerMember = 60, kReevaluated = 300;   // scouts a member: by the peak alone, evaluated again
  constexpr double kSame = 1e-5;
  const Descent& descent = descent_of(fidelity_);
  const bool reevaluates = fidelity_.goal != Goal::kPeak;
  const std::size_t members = std::min(kLargest, kSmallest + std::size_t(populations_));
  if (uses_population()) {
    starts_ = Archive(reevaluates ? 2 * members : members, kSame);
    motions = std::max(motions, long(members) * (reevaluates ? kReevaluated : kPerMember));
    ++populations_;
  } else {
    starts_ = reevaluates ? Archive(descent.starts, descent.separation) : Archive(2, kIncumbentsApart);
  }
  const double enough = search_->share() + share;
  for (long n = 0; n < motions && !over() && search_->share() < enough; n += kBatch) {
    generation_.assign(kBatch, search_->centre());
    for (Candidate& p : generation_) p = draw(centre), p.bound = starts_.bound();
    evaluate_scouts(*search_, Goal::kPeak, starts_, generation_);
  }
  if (reevaluates) reevaluate_starts();
  if (starts_.empty()) return;
  if (!uses_population())
    return descend(Coordinates(starts_.draw_best(random_).u), descent.size, kUnlimited, OnKnownBasin::kAbandon);
  population_.assign(starts_.begin(), starts_.begin() + std::min(members, starts_.size()));
  evolve_population(true);
}

/// A uniform motion, or one of a box around `centre`, outside of the known basins.
Candidate AutoSearch::draw(const Coordinates* centre) {
  constexpr int kAttempts = 20;
  constexpr double kSide = 0.15;
  Candidate p = search_->centre();
  for (int n = 0; n < kAttempts; ++n) {
    p = random_point(random_, search_->objective().variables(), kNeutral);
    if (centre) p.u = (*centre + kSide * (p.u - Coordinates::Constant(p.u.size(), 0.5))).cwiseMax(0).cwiseMin(1);
    if (!basins_.beside(p, kNoMotion)) break;
  }
  return p;
}

/// Evaluates the starts at the fidelity that runs minimise, and sorts them anew.
void AutoSearch::reevaluate_starts() {
  generation_.assign(starts_.begin(), starts_.end());
  starts_.clear();
  for (Candidate& p : generation_) p.bound = kNoMotion, p.worst = -1;
  search_->evaluate(generation_, fidelity_);
  for (const Candidate& p : generation_) starts_.add(p);
}

/// Whether a run's best value exceeds that of the best basin, of its first contact, by more than slack *
/// patience^generation, relative.
bool AutoSearch::lags(const Candidate& best, double slack, double patience, int generation) const {
  return best.value > basins_.lowest(best) * (1 + slack * std::pow(patience, generation));
}

/// Differential evolution until the population has converged, lags behind the best basin, or is in a known one. It
/// needs no gradient, so kinks and cliffs do not stop it, and its spread follows the valleys.
void AutoSearch::evolve_population(bool may_abandon) {
  constexpr std::size_t kFewest = 6;
  constexpr int kFree = 12;
  constexpr double kConverged = 1e-4, kGathered = 0.1, kSlack = 0.12, kPatience = 0.9;
  if (population_.size() < kFewest) return;
  generation_.assign(population_.size(), search_->centre());
  const auto best = [this]() -> const Candidate& { return *std::min_element(population_.begin(), population_.end()); };
  for (int n = 0; !over() && spread(population_) > kConverged; ++n) {
    evolve([this](std::span<Candidate> p) { search_->evaluate(p, fidelity_); }, random_, population_, generation_, {});
    if (!may_abandon || n < kFree) continue;
    const bool gathered = spread(population_) < kGathered;
    if (lags(best(), kSlack, gathered ? kPatience : 1, n - kFree)) break;
    if (gathered && basins_.beside(best(), best().value)) break;
  }
  basins_.add(best());
}

/// A run of covariance matrix adaptation from `start`, `size` as a fraction of the cube.
void AutoSearch::descend(const Coordinates& start, double size, int generations, OnKnownBasin on_known) {
  constexpr double kBound = 1.2;        // of the last generation's median value: above it a motion is abandoned
  constexpr double kContender = 1.005;  // of the lowest value: a run below it converges to the finest width
  constexpr int kFree = 8;
  const Descent& settings = descent_of(fidelity_);
  const int most_stalled = settings.stalled + settings.stalled_per_variable * search_->dimension();
  distribution_->start(start, size, kGeneration);
  Candidate best = search_->centre(), median = best;
  double milestone = kNoMotion;
  for (int n = 0, stalled = 0; n < generations && !over(); ++n) {
    generation_.assign(kGeneration, search_->centre());
    distribution_->sample(random_, generation_);
    if (n == 0) generation_[0].u = start;
    for (Candidate& p : generation_)
      p.bound = std::min(kNoMotion, kBound * median.value), p.stage_values = median.stage_values;
    search_->evaluate(generation_, fidelity_);
    std::sort(generation_.begin(), generation_.end());
    best = std::min(best, generation_[0]);
    distribution_->update(generation_);
    median = generation_[kGeneration / 2];
    const bool improved = best.value < milestone * (1 - settings.min_gain);
    if (improved) milestone = best.value;
    stalled = improved ? 0 : stalled + 1;
    const double converged = best.value > kContender * basins_.lowest() ? settings.coarse : settings.finest;
    if (stalled > most_stalled || distribution_->largest_deviation() < converged) break;
    if (on_known == OnKnownBasin::kAbandon && n > kFree && distribution_->largest_deviation() < kBasinsApart &&
        basins_.beside(best, best.value))
      return;
    if (n > kFree && lags(best, settings.slack, settings.patience, n - kFree)) break;
  }
  basins_.add(best);
}

void auto_search(Search& search) { AutoSearch().run(search); }

}  // namespace ukemi::landing

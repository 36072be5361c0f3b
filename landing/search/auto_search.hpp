// The search of `optimize --solver auto`, and of Planner.
//
// Made for an objective that is a maximum over time (a landing is abandoned as soon as it exceeds its bound), cheap in
// batches, with many basins, cliffs, and kinks along its valleys:
//   1. warm starts are searched for a few generations;
//   2. scouts are drawn uniformly and around the best of earlier ones, ever closer: a hundredth of a second allows no
//      more than this;
//   3. a run descends from the best scouts, each motion followed only while it may still be an improvement; a run that
//      lags behind the best basin is abandoned. With the paper's three variables a run is a population of differential
//      evolution (population.hpp); with more, or under scatter, a covariance matrix adaptation that starts at the best
//      scout (cma.hpp);
//   4. the end of a run is a basin, kept in an archive of those that lie apart; later runs start close to one of them,
//      where narrow minima are, or from the best of a few scouts drawn uniformly (basin hopping).
// For a goal that costs many landings a motion, stages of lower fidelity come first (GoalProfile): each searches basins
// for its share of the budget, and the best of them start the next stage, the last being the goal itself. With more
// than three variables, and under scatter, most later runs would end in known basins: such a run is abandoned once its
// distribution is narrow and close to a better basin.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "common/random.hpp"
#include "landing/search/archive.hpp"
#include "landing/search/search.hpp"

namespace ukemi::landing {

/// The stages of a search for a goal. Scouts are compared by the peak of the planned drop, one landing each.
struct GoalProfile {
  struct Stage {
    Fidelity fidelity;     ///< what runs minimise: cheaper than the goal, with about the same basins
    double end_share = 0;  ///< share of the budget at which it ends, 0..1; 0: no such stage
  };
  Fidelity goal;
  std::array<Stage, 2> low_fidelity{};  ///< before the goal itself, the cheapest first
  double scout_share = 0.7;             ///< maximum share of a stage's budget for its first scouts, 0..1
  bool smooth = false;                  ///< scatter smooths the cliffs: runs start wider and end sooner
  long scout_factor = 1;                ///< multiplies the scouts before a later run, where there are few runs
};
/// `budget`: motions, or landings under scatter.
GoalProfile profile_of(const Objective& objective, double budget);

class CovarianceAdaptation;

class AutoSearch {
 public:
  static constexpr std::size_t kMaxBatch = 48;  ///< largest number of motions played at once over drops
  /// Allocates all that `run` needs.
  AutoSearch();
  ~AutoSearch();
  /// Runs until search.over(). Allocates nothing.
  void run(Search& search);

 private:
  void run_from_warm_starts();
  void run_from_incumbents();
  void run_stage(const GoalProfile::Stage& stage);
  void evaluate_best_basin();
  void refine_basins();
  void hop();
  bool refine_best();
  void run_from_scouts(long motions, double share, const Coordinates* centre);
  void evolve_population(bool may_abandon);
  enum class OnKnownBasin { kContinue, kAbandon };
  void descend(const Coordinates& start, double size, int generations, OnKnownBasin on_known);
  bool lags(const Candidate& best, double slack, double patience, int generation) const;
  Candidate draw(const Coordinates* centre);
  void reevaluate_starts();
  bool over() const { return search_->over() || search_->share() >= end_share_; }
  bool uses_population() const { return search_->dimension() <= kPaperVariables && !profile_.smooth; }

  Search* search_ = nullptr;
  GoalProfile profile_;
  Fidelity fidelity_;     ///< what the present stage minimises
  double end_share_ = 1;  ///< the share of the budget at which it ends, 0..1
  int populations_ = 0;   ///< started so far
  Random random_{0};
  Coordinates refined_;  ///< the last start of a descent by derivatives
  std::unique_ptr<CovarianceAdaptation> distribution_;
  std::vector<Candidate> generation_, population_;
  Archive starts_, basins_, goal_basins_;  ///< goal_basins_: with values of the goal
};

}  // namespace ukemi::landing

// The search of `optimize --solver auto`, and of Planner.
//
// What it is built for: an objective that is a maximum over time (a landing may be abandoned as soon as it is worse
// than what it competes with), cheap in batches, with many basins, kinks along valleys and cliffs. So:
//   1. given starting points are searched for a few generations;
//   2. scouts are drawn anywhere, and close to the best of earlier ones, the closer the fewer are left: all there is
//      time for in a hundredth of a second;
//   3. from the best of them a run descends, each motion followed only while it may still be an improvement; a
//      run that gets worse than the best basin is given up. With the paper's three variables a run is a population of
//      differential evolution (population.hpp), with more, or under scatter, a distribution that starts at the best
//      scout and adapts its covariance (cma.hpp);
//   4. where a run ends is a basin, kept in an archive of those that lie apart; later runs start close to one of them,
//      where narrow minima are, or from the best of a few scouts anywhere else (basin hopping).
// A goal that costs many landings a motion begins with rougher values of it (GoalProfile): for a part of the budget
// each basins are searched by them; the best are where the next value begins, and at last the goal itself. With more
// than three variables, and under scatter, most later runs would end in basins that are known: such a run is given up
// once it is narrow and beside a better one.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "common/random.hpp"
#include "landing/search/archive.hpp"
#include "landing/search/search.hpp"

namespace ukemi::landing {

/// A goal as the search takes it. Scouts are judged by the peak of the planned drop, one landing each.
struct GoalProfile {
  struct Stage {
    Fidelity by;       ///< what runs minimise: it costs less than the goal, and leads to about the same basins
    double until = 0;  ///< share of the budget at which it ends, 0..1; 0: no such stage
  };
  Fidelity goal;
  std::array<Stage, 2> rougher{};  ///< before the goal itself, the roughest first
  double scouting = 0.7;           ///< of what runs have at first, the share that scouts may take, 0..1
  bool smooth = false;             ///< scatter has smoothed the cliffs: runs start wider, and end sooner
  long scouts = 1;                 ///< so many times as usual before a later run, where there are few runs
};
/// For a search of so many motions, or landings under scatter.
GoalProfile profile_of(const Objective::Options& options, double most);

class CovarianceAdaptation;

class AutoSearch {
 public:
  static constexpr std::size_t kAtOnce = 48;  ///< largest number of motions played at once over drops
  /// Allocates all that `run` needs.
  AutoSearch();
  ~AutoSearch();
  /// Searches until the search is over. Allocates nothing.
  void run(Search& search);

 private:
  void follow_hints();
  void run_from_incumbents();
  void look_for_basins(const GoalProfile::Stage& stage);
  void judge_best();
  void judge_basins();
  void hop();
  void run_from_scouts(long motions, double share, const Coordinates* about);
  void converge(bool may_give_up);
  enum class InKnownBasin { kGoesOn, kIsGivenUp };
  void descend(const Coordinates& start, double size, int generations, InKnownBasin run);
  bool lags(double value, double slack, double patience, int generation) const;
  Candidate draw(const Coordinates* about);
  void judge_starts();
  bool over() const { return search_->over() || search_->share() >= until_; }
  bool by_population() const { return search_->dimension() <= kPaperVariables && !profile_.smooth; }

  Search* search_ = nullptr;
  GoalProfile profile_;
  Fidelity by_;       ///< the value that runs minimise at present
  double until_ = 1;  ///< the share of the budget at which they end
  int races_ = 0;     ///< populations so far
  Random random_{0};
  std::unique_ptr<CovarianceAdaptation> distribution_;
  std::vector<Candidate> generation_, population_;
  Archive starts_, basins_, judged_;
};

}  // namespace ukemi::landing

// State shared by all solvers: the remaining budget, the best so far and its history.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <span>

#include "landing/search/archive.hpp"

namespace ukemi::landing {

struct Budget {
  long motions = std::numeric_limits<long>::max();           ///< maximum number evaluated; under scatter landings
  double seconds = std::numeric_limits<double>::infinity();  ///< from the start of the search; a clock is never exact
  long work = kUnbounded;                                    ///< see work_of; judging the result has its own
  double tolerance = 0;   ///< relative: stops once `patience` motions in a row improved the best by less; 0: never
  long patience = 5'000;  ///< [motions]
  double hold = 0.05;     ///< maximum share for postures to hold besides the first; 0: no posture at all
};

/// Maximum work of a search of `motions`, each of `landings`: five times that of ordinary landings, and seconds at
/// least. Ends a search whose landings take a thousand times as long as usual.
long work_allowed(long landings, long motions);

class Search {
 public:
  /// `progress` receives the improvements, up to its capacity; may be null. Evaluates the best posture to hold by the
  /// goal: the answer is no worse, whatever the solver finds.
  Search(Objective& objective, const Budget& budget, std::uint64_t seed, std::vector<Progress>* progress = nullptr);

  /// True once the budget is exhausted.
  bool over() const { return spent() >= budget_.motions || objective_.interrupted() || stalled(); }
  double seconds() const { return objective_.watch.seconds() - start_; }
  long motions() const { return objective_.motions() - first_motion_; }
  /// In the unit of Budget::motions: under scatter landings, as motions take different numbers of them; a motion that
  /// is refused before any landing counts as one.
  long spent() const { return scattered() ? std::max(objective_.landings() - first_landing_, motions()) : motions(); }
  const Budget& budget() const { return budget_; }
  /// Expected final value of `spent`, by the motions of the budget or by its time.
  double expected_total() const;
  /// Share of the budget that is spent, 0..1: of the motions or of the time, whichever is larger.
  double share() const;

  /// Evaluates as many of the points as the budget allows; the others get kNoMotion. Points of lower fidelity than the
  /// goal are only screened: no result before they are evaluated again.
  void evaluate(std::span<Candidate> points, Fidelity fidelity);
  void evaluate(std::span<Candidate> points) { evaluate(points, objective_.goal()); }
  const Candidate& best() const { return contenders_.empty() ? centre_ : contenders_[0]; }
  /// The best posture to hold: the released one; without a release the middle of the scene's range, or the best of some
  /// others within Budget::hold. kNoMotion where it could not be followed within the limits, or the space has none.
  const Candidate& held() const { return held_; }
  int dimension() const { return objective_.dimension(); }
  /// The centre of the space, not evaluated.
  const Candidate& centre() const { return centre_; }

  /// The best motion, verified. The best often lies at a cliff, where the accuracy of the search decides the side: the
  /// contenders and the best posture to hold are evaluated again at tight_accuracy, and where their values jump, a
  /// population steps back from the cliff. Then the scalar path verifies at `accuracy`; the larger value counts. Where
  /// nothing better than holding was evaluated, the best screened motion is; with nothing at all, for 3 ms past the
  /// deadline. Else it ends by `deadline` on the objective's watch: a contender that is not reached is not considered,
  /// and where none is, the value of the search counts. Its work is limited to twice kCheckWork.
  Candidate judge(double accuracy, double deadline = std::numeric_limits<double>::infinity());

  const std::uint64_t seed;
  /// Points of the unit cube that are tried before all others, the best first; they must outlive the search.
  std::span<const Coordinates> warm_starts;
  std::function<void(long done, long total)>
      on_progress;  ///< if set, receives motions, or milliseconds where these are unlimited
  Objective& objective() { return objective_; }
  const Objective& objective() const { return objective_; }

 private:
  void search_held();
  void evaluate_held(Candidate p);
  void evaluate_screened(double deadline);
  /// Whether it may be the answer: followed, and under scatter within the limits in the required share of drops.
  bool valid(const Candidate& p) const { return p.value < kNoMotion && (!scattered() || objective_.keeps_limits(p)); }
  Candidate judge_scattered();
  Candidate judge_exactly(double accuracy);
  void step_back(const Candidate& edge);
  /// Candidates for the answer, sorted: the best that lie apart, then the best posture to hold.
  std::span<Candidate> contenders(std::span<Candidate, Archive::kMost> buffer) const;
  bool scattered() const { return objective_.goal() == Goal::kRobust; }
  /// How many of `motions` the budget allows.
  std::size_t allowed(std::size_t motions) const;
  /// Evaluates, and records contenders and the best screened points.
  void play(std::span<Candidate> points, Fidelity fidelity);
  void play(std::span<Candidate> points) { play(points, objective_.goal()); }
  void record(const Candidate& p);
  void report_progress() const;
  bool stalled() const { return budget_.tolerance > 0 && motions() - milestone_motions_ >= budget_.patience; }

  Objective& objective_;
  Budget budget_;
  double start_;  ///< on the objective's watch [s]
  long first_motion_, first_landing_;
  long milestone_motions_ = 0;    ///< at the last improvement by more than the tolerance
  double milestone_ = kNoMotion;  ///< the best value then
  std::vector<Progress>* progress_;
  const Candidate centre_;
  Archive contenders_;                 ///< the best that lie apart
  Candidate held_;                     ///< see held()
  std::array<Candidate, 2> screened_;  ///< the best of low fidelity: by the peak, over some drops
};

}  // namespace ukemi::landing

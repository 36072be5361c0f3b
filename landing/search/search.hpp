// The bookkeeping that all solvers share: what may still be spent, the best so far, and how it came about.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "landing/search/archive.hpp"

namespace ukemi::landing {

struct Budget {
  long motions = std::numeric_limits<long>::max();           ///< evaluated in all; under scatter landings
  double seconds = std::numeric_limits<double>::infinity();  ///< from the start of the search; a clock is never exact
  long work = kUnbounded;  ///< see work_of; what judging the result takes is granted apart
  double tolerance = 0;    ///< relative: stops once `patience` motions in a row bettered the best by less; 0: never
  long patience = 5'000;   ///< [motions]
  double hold = 0.05;      ///< share that may go into postures to hold, besides the first; 0: none, for a single basin
};

/// What a search of so many motions, each of so many landings, may take: five times what ordinary landings do, each
/// motion followed to its end, and seconds at least. Where landings take a thousand times as long as usual, it ends
/// there and not in hours.
long work_allowed(long landings, long motions);

class Search {
 public:
  /// `progress` receives the moments, up to its capacity; null where nobody asks. Judges the best posture to hold, by
  /// the search's own goal: whatever a solver does with what is left, the answer is no worse.
  Search(Objective& objective, const Budget& budget, std::uint64_t seed, std::vector<Progress>* progress = nullptr);

  /// True once nothing may be spent any more.
  bool over() const { return spent() >= budget_.motions || objective_.late() || stalled(); }
  double seconds() const { return objective_.watch.seconds() - start_; }
  long motions() const { return objective_.motions() - first_motion_; }
  /// As Budget::motions: under scatter, where a motion is worth as many landings as it may win, the landings; a motion
  /// that is refused before any landing counts as one.
  long spent() const { return scattered() ? std::max(objective_.landings() - first_landing_, motions()) : motions(); }
  const Budget& budget() const { return budget_; }
  /// As many as `spent` may become: by the budget, or by its time where that is short.
  double most() const;
  /// How much is spent, 0..1: of the motions or of the time, whichever is more.
  double share() const;

  /// Evaluates as many of the points as the budget allows; the others come back with kNoMotion. What is rougher than
  /// the search's own goal only screens: it is no result until it is played again.
  void evaluate(std::span<Candidate> points, Fidelity fidelity);
  void evaluate(std::span<Candidate> points) { evaluate(points, objective_.options().goal); }
  const Candidate& best() const { return contenders_.empty() ? none_ : contenders_[0]; }
  /// The best posture to hold: the one that the robot is released in; without a release the middle of the scene's
  /// range, or the best of some others, as far as a twentieth of the budget goes. kNoMotion where it could not be
  /// followed within the limits, or the space knows none.
  const Candidate& held() const { return held_; }
  int dimension() const { return objective_.space().dimension(); }
  /// The middle of the space, not yet played.
  const Candidate& nothing() const { return none_; }

  /// The best that stands. Many a best stands on a cliff, where what the search's own accuracy took for a foothold may
  /// be beside it: the best few, and the best posture to hold, are evaluated anew at 1e-9, and where they have fallen,
  /// the search steps back from the edge. Then the scalar path judges at `accuracy`; the worse of the two counts. Where
  /// nothing better than holding was played, the best that was screened is; where nothing at all stands, for 3 ms if
  /// need be. All else until `deadline` on the objective's watch: what it cuts off is not judged, and where it comes
  /// first of all, the search's own value stands. Of work, judging has twice kCheckWork.
  Candidate judge(double accuracy, double deadline = std::numeric_limits<double>::infinity());

  const std::uint64_t seed;
  /// Places in the unit cube that are tried before all others, the best first; they must outlive the search.
  std::span<const Coordinates> hints;
  std::function<void(long done, long total)>
      on_progress;  ///< receives the motions spent, else the milliseconds, if set
  const Objective& objective() const { return objective_; }
  /// Landings that a solver played by itself.
  void spend(const integrate::Counters& work) { objective_.spend(work_of(work)); }

 private:
  void hold();
  void judge_held(Candidate p);
  void play_screened(double deadline);
  /// Whether it may be the answer: followed, and under scatter within the limits in as many drops as are asked for.
  bool stands(const Candidate& p) const { return p.value < kNoMotion && (!scattered() || objective_.keeps_limits(p)); }
  Candidate judge_scattered();
  Candidate judge_exactly(double accuracy);
  void step_back(const Candidate& edge);
  /// What an answer is chosen from, in order: the best few, and the best posture to hold, however many are better.
  std::span<Candidate> contenders(std::span<Candidate, Archive::kMost> memory) const;
  bool scattered() const { return objective_.options().goal == Goal::kRobust; }
  /// How many of so many motions the budget allows.
  std::size_t allowed(std::size_t motions) const;
  /// Evaluates, and keeps what is good enough.
  void play(std::span<Candidate> points, Fidelity fidelity);
  void play(std::span<Candidate> points) { play(points, objective_.options().goal); }
  void keep(const Candidate& p);
  void report() const;
  bool stalled() const { return budget_.tolerance > 0 && motions() - milestone_motions_ >= budget_.patience; }

  Objective& objective_;
  Budget budget_;
  double start_;  ///< on the objective's watch [s]
  long first_motion_, first_landing_;
  long milestone_motions_ = 0;    ///< when the best last became better by more than the tolerance
  double milestone_ = kNoMotion;  ///< and what it was then
  std::vector<Progress>* progress_;
  const Candidate none_;
  Archive contenders_;                 ///< the best that are apart
  Candidate held_;                     ///< see held()
  std::array<Candidate, 2> screened_;  ///< the best by what is rougher: by one landing, over some drops
};

}  // namespace ukemi::landing

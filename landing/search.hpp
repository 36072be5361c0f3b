// The bookkeeping that all solvers share: what may still be spent, the best so far, and how it came about.
#pragma once

#include <cstdint>

#include "landing/objective.hpp"

namespace ukemi::landing {

struct Budget {
  long motions = std::numeric_limits<long>::max();               ///< evaluated in all
  double seconds = std::numeric_limits<double>::infinity();      ///< from the start of the search; a clock is never exact
};

/// A moment at which the best became better.
struct Progress {
  long motions, landings;
  double seconds;
  Point3 best;
};

class Search {
 public:
  Search(Objective& objective, const Budget& budget, std::uint64_t seed);

  /// True once nothing may be spent any more.
  bool over() const { return objective_.motions() - first_motion_ >= budget_.motions || objective_.late(); }
  double seconds() const { return std::chrono::duration<double>(Objective::Clock::now() - start_).count(); }
  long motions() const { return objective_.motions() - first_motion_; }
  const Budget& budget() const { return budget_; }
  /// How much is spent, 0..1: of the motions or of the time, whichever is more.
  double share() const;

  /// Evaluates as many of the points as the budget allows; the others come back with kNoMotion.
  void evaluate(std::span<Point3> points);
  const Point3& best() const { return few_[0]; }

  /// The best that stands at a tight accuracy: what the search took for a foothold on a cliff may be beside it.
  Point3 verified_best(double accuracy) const;

  const std::uint64_t seed;
  std::vector<Progress> progress;  ///< reserved; no more is written than that
  const Objective& objective() const { return objective_; }

 private:
  void keep(const Point3& p);

  Objective& objective_;
  Budget budget_;
  Objective::Clock::time_point start_;
  long first_motion_;
  std::array<Point3, 12> few_;  ///< the best, in order
};

}  // namespace ukemi::landing

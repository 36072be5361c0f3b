// The search of `auto` for plans under scatter. A value costs as many landings as there are drops, and a few drops are
// enough to leave the cliffs of a single one and to tell good places from bad ones; so
//
//   1. many motions from anywhere are judged by the planned drop alone, the best of them by a few drops; from the best
//      of these a normal distribution (cma.hpp) finds its way down over those few drops; a run that falls behind is
//      given up; later runs start beside what was found, or from anywhere again;
//   2. in the last part of the budget the best basins are searched over all drops.
// Private: not installed.
#pragma once

#include <vector>

#include "common/random.hpp"
#include "landing/search/auto_settings.hpp"
#include "landing/search/cma.hpp"
#include "landing/search/search.hpp"

namespace ukemi::landing {

class RobustSearch {
 public:
  explicit RobustSearch(const AutoSettings& settings = {});
  /// Allocates nothing that an earlier run of the same kind has not allocated.
  void run(Search& search);

 private:
  /// That the first runs are made over.
  std::size_t few_drops() const;
  void look_for_basins();
  bool judge_best();
  void search_basins();
  Candidate scouted();
  /// A run from a place, of a size in parts of the cube, over so many drops, until that share of the budget is spent.
  void close_in(const Candidate& start, double size, std::size_t drops, double until);
  bool behind(double value, int generation) const;
  void know(const Candidate& p);

  AutoSettings set_;
  Search* search_ = nullptr;
  Random random_{0};
  CovarianceAdaptation distribution_;
  std::vector<Candidate> generation_, starts_, basins_, best_;
};

}  // namespace ukemi::landing

// The search of `auto` over more variables than the paper's three, and the solver `cma`.
//
//   1. the best of many motions from anywhere, far apart, are starts;
//   2. from a start a narrow distribution (cma.hpp) finds its way down; a run that falls behind the best is given up;
//   3. later runs start by turns beside the best basins, at any width, and from the best of a few motions from
//   anywhere.
// Tolerant peaks: half of the budget goes into basins of the peak alone, a lower bound that costs one landing in place
// of fifteen; the best of them are then judged, and searched, by the tolerant peak in the other half.
// Private: not installed.
#pragma once

#include <vector>

#include "common/random.hpp"
#include "landing/search/auto_settings.hpp"
#include "landing/search/cma.hpp"
#include "landing/search/search.hpp"

namespace ukemi::landing {

class WideSearch {
 public:
  /// Allocates all that the search needs.
  explicit WideSearch(const AutoSettings& settings = {});
  /// Begins anew, with nothing known. This and what follows allocates nothing.
  void begin(Search& search);
  /// A point that is known to be good: later runs start beside it.
  void know(const Candidate& p);
  /// The best of motions from anywhere. For tolerant peaks the basins of the peak are looked for first.
  void scout_first();
  /// One run: beside what is known, or from anywhere.
  void run_once();

 private:
  void screen();
  void scout(int motions);
  void keep(std::vector<Candidate>& best, std::size_t most, double apart, const Candidate& p);
  void start_anywhere();
  void start_beside_a_basin();
  void close_in(const Candidate& start, double size);
  bool behind(double value, int generation) const;
  bool over() const { return search_->over() || search_->share() >= until_; }

  double best_known() const;

  AutoSettings set_;
  Search* search_ = nullptr;
  Goal goal_ = Goal::kPeak;  ///< that runs go by, at present
  double until_ = 1;         ///< and the share of the budget that they end at
  Random random_{0};
  CovarianceAdaptation distribution_;
  std::vector<Candidate> generation_, starts_, basins_, kept_;
};

}  // namespace ukemi::landing

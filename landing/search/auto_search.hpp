// The search of `optimize --solver auto`, and of Planner.
//
// What it is built for: an objective that is a maximum over time (a landing may be abandoned as soon as it is worse
// than what it competes with), cheap in batches, with many basins, kinks along valleys and cliffs. So:
//   1. scouts go anywhere, and close by the best of those before them, the closer the fewer are left: all there is
//      time for in a hundredth of a second; the best of them are the first population;
//   2. a race of motions from anywhere, each followed only while it may belong to the best, gives the next ones
//      (tolerant peaks: by the peak alone first, a lower bound that costs one landing);
//   3. a population converges by differential evolution (population.hpp), whose trials are abandoned at their
//      parent's value; it needs no slope, so kinks and cliffs do not stop it, and its spread follows the valleys;
//   4. one that falls behind the best so far, or into a known basin, is given up; one that converges is a basin, and
//      the next races keep away from it: half of them anywhere, half close by the best basins, where thin cracks are;
//   5. now and then, and at the end, the best basin is searched once more from close by.
// Over more than three variables the scouts are followed by runs of WideSearch (wide_search.hpp). Under scatter it is
// RobustSearch (robust_search.hpp) that searches.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "common/random.hpp"
#include "landing/search/auto_settings.hpp"
#include "landing/search/search.hpp"

namespace ukemi::landing {

class RobustSearch;
class WideSearch;

class AutoSearch {
 public:
  /// Allocates all that `run` needs. Throws InputError for settings out of range.
  explicit AutoSearch(const AutoSettings& settings = {});
  ~AutoSearch();
  /// Searches until the search is over. Allocates nothing.
  void run(Search& search);

 private:
  std::vector<Candidate>::iterator basin_of(const Candidate& p);
  void choose_region(int n);
  Candidate fresh();
  bool ending() const;
  void follow_hints();
  void scout();
  void lead(const Candidate& p);
  void take(std::vector<Candidate>& best, int most, double apart, const Candidate& p);
  void race(double share);
  void fill(int entrants, Goal goal, int places, double share);
  void enter(std::span<Candidate> points, Goal goal, int places);
  void converge(double side, bool may_give_up);
  void remember();
  void refine();

  AutoSettings set_;
  std::unique_ptr<RobustSearch> robust_;
  std::unique_ptr<WideSearch> wide_;
  bool refined_last_ = false;
  int size_ = 0;
  Candidate centre_;  // of the region where the next race is run
  double side_ = 1;
  Search* search_ = nullptr;
  Random random_{0};
  std::vector<Candidate> population_, trials_, basins_, leads_, batch_;
};

}  // namespace ukemi::landing

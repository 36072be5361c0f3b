// Local searches from many starts: the best minimum that they end at, which others there are, and when to stop.
#pragma once

#include <functional>
#include <limits>
#include <vector>

#include "common/monitor.hpp"
#include "identify/estimate/least_squares.hpp"

namespace ukemi::identify {

struct MultiStartOptions {
  /// Whether a minimum is good enough for no further start to be tried; empty: none is.
  std::function<bool(const LeastSquaresSolution&)> believed;
  double work = std::numeric_limits<double>::infinity();  ///< once the searches spent it no further start is tried
  int same = 5;             ///< the best minimum, found so often, is taken for the global one, >= 1
  int at_once = 2;          ///< starts of a batch, whatever the number of threads, >= 1
  double same_cost = 1e-6;  ///< costs relatively this near are one minimum's
  long most = 0;            ///< starts that there may be, for the monitor
  int threads = 0;          ///< 0: all cores; without influence on the results
  Monitor monitor;          ///< told of each start; where it stops no further one is tried
};

class MultiStart {
 public:
  /// The local search from a start: what it ended at, and the work that it spent. Called from several threads at once.
  using Search = std::function<LeastSquaresSolution(int start)>;

  /// A minimum that converged searches ended at.
  struct Minimum {
    LeastSquaresSolution solution;  ///< the lowest of them
    int start;                      ///< which ended there, counted from the first of all
    int found;                      ///< by so many
  };

  explicit MultiStart(MultiStartOptions options) : options_(std::move(options)) {
    best_.cost = std::numeric_limits<double>::infinity();
  }

  /// Searches from the starts 0 .. count - 1, whatever they find.
  void search_all(int count, const Search& search);
  /// The same in batches, in order, while no minimum is believed, none was found often enough, and work is left.
  void search_until_believed(int count, const Search& search);
  /// Drops what was found, not what was spent: the problem has changed.
  void forget();

  /// The lowest usable solution; where there is none, the first message of those that are not.
  const LeastSquaresSolution& best() const { return best_; }
  int best_start() const { return best_start_; }  ///< counted from the first of all
  bool believed() const { return best_.usable && options_.believed && options_.believed(best_); }
  std::vector<Minimum> minima() const;  ///< the lowest first
  int starts() const { return starts_; }

 private:
  void search_batch(int first, int count, const Search& search);
  void add(LeastSquaresSolution solution);

  MultiStartOptions options_;
  LeastSquaresSolution best_;
  int best_start_ = -1, times_found_ = 0, starts_ = 0;
  double spent_ = 0;
  std::vector<Minimum> minima_;
};

}  // namespace ukemi::identify

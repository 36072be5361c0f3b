// Local searches from many starts: the best minimum, the other minima, and when to stop.
#pragma once

#include <functional>
#include <limits>
#include <vector>

#include "common/monitor.hpp"
#include "identify/estimate/least_squares.hpp"

namespace ukemi::identify {

struct MultiStartOptions {
  /// Whether a minimum is good enough to stop: no further start is tried. Empty: none is.
  std::function<bool(const LeastSquaresSolution&)> believed;
  double work = std::numeric_limits<double>::infinity();  ///< no further start is tried once the searches have spent it
  int same = 5;             ///< the best minimum is taken as global once found this many times, >= 1
  int at_once = 2;          ///< starts per batch, independent of the number of threads, >= 1
  double same_cost = 1e-6;  ///< relative difference up to which two costs are the same minimum's
  long most = 0;            ///< maximum number of starts, for the monitor
  int threads = 0;          ///< 0: all cores; without influence on the results
  Monitor monitor;          ///< progress after each start; if it stops, no further one is tried
};

class MultiStart {
 public:
  /// The local search from a start: its solution, with the work spent. Called from several threads at once.
  using Search = std::function<LeastSquaresSolution(int start)>;

  /// A minimum at which searches converged.
  struct Minimum {
    LeastSquaresSolution solution;  ///< the lowest of them
    int start;                      ///< index of its start among all starts
    int found;                      ///< number of searches that converged to it
  };

  explicit MultiStart(MultiStartOptions options) : options_(std::move(options)) {
    best_.cost = std::numeric_limits<double>::infinity();
  }

  /// Searches from all starts 0 .. count - 1.
  void search_all(int count, const Search& search);
  /// Searches in batches, in order, until a minimum is believed or found often enough, or the work is spent.
  void search_until_believed(int count, const Search& search);
  /// Discards the solutions, but not the work spent: the problem has changed.
  void forget();

  /// The usable solution of lowest cost; without one, the first message of the unusable ones.
  const LeastSquaresSolution& best() const { return best_; }
  int best_start() const { return best_start_; }  ///< index among all starts
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

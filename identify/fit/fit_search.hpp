// The search of a fit: local searches from the given start, from starts that are drawn to explore, or from screened
// ones until a minimum is accepted.
#pragma once

#include <atomic>
#include <optional>
#include <string>
#include <vector>

#include "identify/estimate/multi_start.hpp"
#include "identify/fit/rig_terms.hpp"
#include "identify/fit/trial_problem.hpp"
#include "identify/fit/weighting.hpp"

namespace ukemi::identify {

class FitSearch {
 public:
  using Sea = SeaParameters<double>;

  /// The arguments must outlive it. Throws InputError where there is no trial or no measured angle.
  FitSearch(const Rig& rig, const std::vector<Trial>& trials, const std::optional<Sea>& start, const Sea& base,
            const FitOptions& options);

  /// Searches from as many starts as the options request or the residual requires.
  void run();
  /// Discards the solutions and searches once more from `from`: the weights have changed.
  void restart(const Sea& from);

  const LeastSquaresSolution& best() const { return multi_start_.best(); }
  int starts() const { return multi_start_.starts(); }
  std::vector<Minimum> minima() const;
  SeaParameters<double> best_sea() const { return sea_of(best(), best_from()); }
  /// The problem that the best solution solves.
  LeastSquaresProblem best_problem() const { return problem(best_from(), nullptr); }
  /// Why a start was ended early: its budget of work was spent; empty where none was.
  std::string stop_reason() const;
  /// f(rig, inputs, trial) of trial m at the best solution, with the terms' changes applied (RigTerm::change).
  template <class F>
  auto at_best(std::size_t m, F&& f) const {
    const Eigen::VectorXd locals = best().locals.row(long(m));
    const RigPoint point(layout_, best().globals.data(), locals.data());
    return point.with_changes(
        rig_, best_from(), prepared_[m],
        [&](const Rig& r, const Sea& sea, const PreparedTrial& t) { return f(r, point.inputs(sea), t); });
  }

  const RigLayout& layout() const { return layout_; }
  const std::vector<PreparedTrial>& prepared() const { return prepared_; }
  std::vector<Weighting>& weights() { return weights_; }  ///< of the trials' residuals
  double noise() const { return noise_; }                 ///< of the logs [rad]

 private:
  LeastSquaresProblem problem(const Sea& from, Budget* budget) const;
  Sea sea_of(const LeastSquaresSolution& solution, const Sea& from) const;
  const Sea& best_from() const { return start_points_[std::size_t(multi_start_.best_start())]; }
  /// Copies the values of the actuator's fitted optional terms that are not absent.
  void copy_optional_terms(const Sea& from, Sea& to) const;
  /// A drawn start clamped to the bounds; what is not free stays as given.
  Sea clamped(const Sea& drawn) const;
  /// Drawn starts, lowest cost first, by coarse rollouts of two trials.
  std::vector<Sea> candidates() const;
  /// The local search from start_points_[first + i].
  MultiStart::Search search(std::size_t first);

  const double measurements_;  ///< number of them, > 0
  const Rig& rig_;
  const std::optional<Sea>& start_;
  const Sea& base_;
  const FitOptions& options_;
  const RigLayout layout_;
  const LeastSquaresOptions solver_;
  const Suggestion suggestion_;
  const std::vector<PreparedTrial> prepared_;
  std::vector<Weighting> weights_;
  const double noise_, work_per_start_;
  MultiStart multi_start_;
  std::vector<Sea> start_points_;
  std::atomic<bool> budget_spent_{false};
};

}  // namespace ukemi::identify

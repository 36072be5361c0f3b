// The search of a fit: one problem, from the given start, from starts that are drawn to explore, or from screened ones
// until a minimum is believed.
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

  /// What it is made from must outlive it. Throws InputError where there is no trial or no measured angle.
  FitSearch(const Rig& rig, const std::vector<Trial>& trials, const std::optional<Sea>& start, const Sea& base,
            const FitOptions& options);

  /// As many starts as the options ask for or the noise calls for.
  void run();
  /// Forgets what was found, and starts once more from there: the weights have changed.
  void run_again(const Sea& from);

  const LeastSquaresSolution& best() const { return starts_.best(); }
  int starts() const { return starts_.starts(); }
  std::vector<Minimum> minima() const;
  SeaParameters<double> best_sea() const { return sea_of(best(), best_from()); }
  /// The problem that the best solution solves.
  LeastSquaresProblem best_problem() const { return problem(best_from(), nullptr); }
  /// That a start was ended, for its work was spent; empty where none was.
  std::string spent() const;
  /// f(rig, inputs, trial) at the best solution, with what the terms without a field change.
  template <class F>
  auto at_best(std::size_t m, F&& f) const {
    const Eigen::VectorXd own = best().locals.row(long(m));
    const RigPoint point(layout_, best().globals.data(), own.data());
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
  const Sea& best_from() const { return tried_[std::size_t(starts_.best_start())]; }
  /// Takes the values of the actuator's fitted terms beside the five constants, where they are there.
  void take_terms(const Sea& from, Sea& to) const;
  /// A drawn start within the bounds; what is not free stays as given.
  Sea admitted(const Sea& drawn) const;
  /// Starts, best first, judged on a coarse rollout of two trials.
  std::vector<Sea> candidates() const;
  /// The local search from tried_[first + i].
  MultiStart::Search search(std::size_t first);

  const double measured_;  ///< angles, > 0
  const Rig& rig_;
  const std::optional<Sea>& start_;
  const Sea& base_;
  const FitOptions& options_;
  const RigLayout layout_;
  const LeastSquaresOptions solver_;
  const Suggestion suggestion_;
  const std::vector<PreparedTrial> prepared_;
  std::vector<Weighting> weights_;
  const double noise_, work_of_start_;
  MultiStart starts_;
  std::vector<Sea> tried_;
  std::atomic<bool> out_of_work_{false};
};

}  // namespace ukemi::identify

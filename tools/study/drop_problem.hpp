// The least-squares problem of drops with one layout of terms, and its solution from a start. Private to the fits of
// tools/study.
#pragma once

#include <limits>
#include <vector>

#include "common/random.hpp"
#include "tools/study/drop_residuals.hpp"

namespace ukemi::tools {

inline constexpr double kWhole = std::numeric_limits<double>::infinity();  ///< horizon of the whole drops
inline constexpr int kPartIterations = 12;  ///< at most, of the solver in a part that is not the whole

/// The indices of all drops.
std::vector<std::size_t> every_drop(const DropSimulator& simulator);

/// Keeps references to its arguments.
struct DropProblem {
  /// Start values of the layout's shared terms.
  using Start = std::vector<double>;
  using Problem = identify::LeastSquaresProblem;
  using Solution = identify::LeastSquaresSolution;

  const DropSimulator& simulator;
  const DropLayout layout;
  const CalibrationOptions& options;
  const std::vector<std::size_t> subset;  ///< indices of the drops
  const std::vector<double> horizons;     ///< of the parts, after the first touchdown [s]
  std::vector<DropResiduals> residuals;   ///< by drop of the subset
  mutable long steps = 0, parts = 0;      ///< integrated, and completed, so far
  mutable bool work_exceeded = false;     ///< a start was stopped at its limit of work

  /// Of all drops.
  DropProblem(const DropSimulator& simulator, DropLayout layout, const CalibrationOptions& options);
  DropProblem(const DropSimulator& simulator, DropLayout layout, const CalibrationOptions& options,
              std::vector<std::size_t> subset);
  DropProblem(const DropProblem&) = delete;

  /// The scene's constants; other terms at the values at which they have no effect.
  Start given() const;
  /// The problem at `start`, each drop up to `horizon` seconds after its first touchdown. Unless that is the whole,
  /// weak priors hold the constants near the start: a short part may not determine all of them.
  Problem problem(const Start& start, const std::vector<double>& sigma, double horizon) const;
  /// The problem of the whole drops, started at a solution.
  Problem problem_from(const Solution& solution, const std::vector<double>& sigma) const;
  /// Limit of the work from one start [integrated steps].
  double work_of_start() const;
  /// Stops when the relative decrease of the cost is below the tolerance, or `steps` exceeds `max_steps`.
  Solution solve(const Problem& problem, int iterations, long max_steps, double tolerance = kSearchTolerance) const;
  /// Solves from `start` over growing parts. Where the monitor stops it or its work exceeds the limit: the solution of
  /// the last complete part, not converged; only costs of the whole drops are comparable.
  Solution solve_in_parts(Start start, const std::vector<double>& sigma) const;
  /// Free constants drawn about the scene's.
  Start drawn(Random random) const;
  std::vector<DropResult> replay(const Solution& solution) const;

 private:
  static constexpr double kSearchTolerance = 1e-6;  ///< relative decrease of the cost that ends a search from a start
  /// The solution's constants; other terms as in `from`.
  Start constants_at(const Solution& solution, Start from) const;
};

}  // namespace ukemi::tools

// The least-squares problem of drops with one layout of terms, and how it is searched from a start. Private to the
// fits of tools/study.
#pragma once

#include <limits>
#include <vector>

#include "common/random.hpp"
#include "tools/study/drop_residuals.hpp"

namespace ukemi::tools {

inline constexpr double kWhole = std::numeric_limits<double>::infinity();  ///< of a part: all of the drops
inline constexpr int kPartIterations = 12;  ///< of the solver, at most, in a part that is not the whole

/// The places of all drops.
std::vector<std::size_t> every_drop(const DropSimulator& simulator);

/// What it is made from must outlive it.
struct DropProblem {
  /// Values of the layout's shared terms: where a search starts.
  using Start = std::vector<double>;
  using Problem = identify::LeastSquaresProblem;
  using Solution = identify::LeastSquaresSolution;

  const DropSimulator& simulator;
  const DropLayout layout;
  const CalibrationOptions& options;
  const std::vector<std::size_t> which;  ///< of the drops
  const std::vector<double> horizons;
  std::vector<DropResiduals> models;
  mutable long steps = 0, parts = 0;  ///< integrated, and done, so far
  mutable bool spent = false;         ///< a start was ended because its work was spent

  /// Of all drops.
  DropProblem(const DropSimulator& simulator, DropLayout layout, const CalibrationOptions& options);
  DropProblem(const DropSimulator& simulator, DropLayout layout, const CalibrationOptions& options,
              std::vector<std::size_t> some);
  DropProblem(const DropProblem&) = delete;

  /// The scene's constants; what is not a constant is absent.
  Start given() const;
  /// From `start`, `after` seconds beyond each drop's first touchdown. Where that is not the whole, the constants are
  /// held loosely to the start: what so short a part does not determine must not run away.
  Problem problem(const Start& start, const std::vector<double>& sigma, double after) const;
  /// The whole, from a solution of it.
  Problem problem_from(const Solution& solution, const std::vector<double>& sigma) const;
  /// The work that a start may take [integrated steps].
  double work_of_start() const;
  /// Ends where the relative fall of the cost is below the tolerance, or the steps are more than `until`.
  Solution solve(const Problem& problem, int iterations, long until, double tolerance = kSearched) const;
  /// From `start`, part by part. Where the monitor stops it or its work is spent: the last part that was done, not
  /// converged; of parts that are not the whole no cost is comparable.
  Solution solve_in_parts(Start start, const std::vector<double>& sigma) const;
  /// Free constants drawn about the scene's own.
  Start drawn(Random random) const;
  std::vector<DropResult> replay(const Solution& solution) const;

 private:
  static constexpr double kSearched = 1e-6;  ///< relative fall of the cost that ends a search from a start
  /// The solution's constants; what is no constant starts anew.
  Start constants_at(const Solution& solution, Start from) const;
};

}  // namespace ukemi::tools

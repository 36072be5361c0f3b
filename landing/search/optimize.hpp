// Eq. 6 of [1]: the motion with the smallest peak acceleration of the thigh, or with the smallest tolerant peak.
//
//     min f(x) = max over time of |ddr_0|,   x = [phi_I phi_F t],   within the scene's search range.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/monitor.hpp"
#include "landing/model/variables.hpp"
#include "landing/run/landing.hpp"
#include "landing/search/goal.hpp"

namespace ukemi {
enum class StopwatchTime : int;
}

namespace ukemi::landing {

class MotionSpace;
struct Robust;

struct OptimizeOptions {
  std::string solver = "auto";           ///< one of solver_names()
  Goal goal = Goal::kPeak;               ///< what is minimised
  std::shared_ptr<const Robust> robust;  ///< for Goal::kRobust
  std::optional<long> evaluations;  ///< motions in all, with Goal::kRobust landings; absent: default_evaluations, or no
                                    ///< bound with a deadline
  std::optional<double> deadline;   ///< [s], > 0: `optimize` returns by then with the best so far
  StopwatchTime time{};             ///< clock of the deadline: wall time, or processor time (on one thread)
  /// Relative: stops once 5000 motions in a row improved the best by less; 0: never.
  double tolerance = 0;
  Limits limits;                  ///< that every landing must keep
  double search_accuracy = 1e-6;  ///< of the landings that are searched
  double accuracy = 1e-9;         ///< of the result
  std::uint64_t seed = 1;
  /// Warm starts, as values of the space's variables: the search begins at the best of them.
  std::vector<MotionValues> starts;
  int threads = 0;               ///< 0: all cores; with a number of evaluations the result does not depend on it
  int tolerance_samples = 2000;  ///< random points inside the execution box of the result; with a deadline none
  Monitor monitor;               ///< progress in motions; where it stops, the best so far is verified within kLeave
  void validate() const;         ///< throws InputError
  static constexpr double kLeave = 0.15;  ///< [s]
};
/// Motions; for Goal::kRobust landings. Fewer for the tolerant peak, which costs several landings a motion.
constexpr long default_evaluations(Goal goal, int variables = kPaperVariables) {
  if (goal == Goal::kRobust) return 100'000L * std::max(1, variables - 2);
  const long factor = variables > kPaperVariables ? 2 * (variables - 2) : 1;  // basins grow quicker than their box
  return factor * (goal == Goal::kPeak ? 40'000 : 10'000);
}

/// A constant reference: the best posture to hold that a search has found.
struct Held {
  Motion motion{};
  double value = kNoMotion;  ///< the goal, as searched [m/s^2]; kNoMotion where it breaks a limit
  double tolerant = std::numeric_limits<double>::quiet_NaN();  ///< tolerant peak [m/s^2]; NaN where not played
};

struct Optimum {
  Motion motion{};
  SeaParameters<double> sea;       ///< the drive that plays it
  MotionValues values;             ///< of the space's variables
  Edges edges{};                   ///< edges of the search box on which `values` lie
  std::optional<Held> held;        ///< absent where the space has no posture to hold; `value` is no worse than it
  LandingPeak landing;             ///< of the motion, at OptimizeOptions::accuracy
  TolerantPeak tolerant;           ///< of the motion within the execution tolerance
  double value = kNoMotion;        ///< the goal, at OptimizeOptions::accuracy
  long evaluations = 0;            ///< motions that were searched
  long landings = 0;               ///< played, abandoned ones and the verification included
  double seconds = 0;              ///< from the call to the answer
  long work = 0;                   ///< of the search, see work_of
  std::vector<Progress> progress;  ///< improvements of the best, at search_accuracy
  std::string solver;              ///< OptimizeOptions::solver
  bool found = false;              ///< false: no motion of the range could be followed within the limits
  bool verified = false;           ///< `landing` was played to its end; else its peak is that of the search, or NaN
  std::string message;             ///< why nothing was found, or why the search ended early
};

/// Searches with one of the solvers of solvers.hpp, then verifies the best at a tight accuracy. Deterministic for a
/// seed and a number of evaluations, whatever the number of threads; with a deadline the clock decides, and the time of
/// the verification is reserved: that of some landings at the centre of the box, which is measured. However stiff the
/// scene, a search of a number of motions ends with work_allowed, which is counted, not timed.
[[nodiscard]] Optimum optimize(const Scene& scene, const MotionSpace& space, const OptimizeOptions& options = {});
/// `optimize` over the motions of Eq. 6.
[[nodiscard]] Optimum optimize(const Scene& scene, const SeaParameters<double>& sea,
                               const OptimizeOptions& options = {});

}  // namespace ukemi::landing

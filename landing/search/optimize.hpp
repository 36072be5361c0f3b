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
  std::optional<double> deadline;   ///< [s], > 0: `optimize` returns by then, whatever has been found
  StopwatchTime time{};  ///< that the deadline is counted in: what a robot waits, or the processor's, on one thread
  /// Relative: stops once 5000 motions in a row bettered the best by less; 0: never.
  double tolerance = 0;
  Limits limits;                  ///< what no landing may do
  double search_accuracy = 1e-6;  ///< of the landings that are searched
  double accuracy = 1e-9;         ///< of the result
  std::uint64_t seed = 1;
  /// Motions that are tried before all others, as values of the space's variables: the search begins at the best.
  std::vector<MotionValues> starts;
  int threads = 0;               ///< 0: all cores; with a number of evaluations the result does not depend on it
  int tolerance_samples = 2000;  ///< random points inside the execution box of the result; with a deadline none
  Monitor monitor;               ///< progress in motions; where it stops, the best so far is judged in kLeave
  void validate() const;         ///< throws InputError
  static constexpr double kLeave = 0.15;  ///< [s]
};
/// A motion's tolerant peak costs several landings. Under scatter, landings.
constexpr long default_evaluations(Goal goal, int variables = kPaperVariables) {
  if (goal == Goal::kRobust) return 100'000L * std::max(1, variables - 2);
  const long more = variables > kPaperVariables ? 2 * (variables - 2) : 1;  // basins grow quicker than their box
  return more * (goal == Goal::kPeak ? 40'000 : 10'000);
}

/// A constant reference, in the best posture to hold that a search has found.
struct Held {
  Motion motion{};
  double value = kNoMotion;  ///< the goal, as searched [m/s^2]; kNoMotion where it keeps no limits
  double tolerant = std::numeric_limits<double>::quiet_NaN();  ///< tolerant peak [m/s^2]; NaN where not played
};

struct Optimum {
  Motion motion{};
  SeaParameters<double> sea;       ///< the drive that plays it
  MotionValues values;             ///< of the space's variables
  Edges edges{};                   ///< of the search box that they lie on
  std::optional<Held> held;        ///< absent where the space knows no posture to hold; `value` is no worse
  LandingPeak landing;             ///< of the motion, at OptimizeOptions::accuracy
  TolerantPeak tolerant;           ///< the same within the execution tolerance
  double value = kNoMotion;        ///< the goal, at OptimizeOptions::accuracy
  long evaluations = 0;            ///< motions that were searched
  long landings = 0;               ///< followed for them, abandoned ones and the verification included
  double seconds = 0;              ///< from the call to the motion
  long work = 0;                   ///< that the search took, see work_of
  std::vector<Progress> progress;  ///< how the best came about, in the search's accuracy
  std::string solver;              ///< that found it
  bool found = false;              ///< false: no motion of the range could be followed within the limits
  bool verified = false;  ///< `landing` was played to its end; else its peak is what the search knows of it, or NaN
  std::string message;    ///< why nothing was found, or why the search ended before all was spent
};

/// Searches with one of the solvers of solvers.hpp, then judges the best at a tight accuracy. Deterministic for a seed
/// and a number of evaluations, whatever the number of threads; with a deadline the clock decides, and what judging
/// takes is kept back from it: some landings as long as that in the middle of the box, whose time is measured. However
/// stiff the scene, a search of a number of motions ends with work_allowed, counted and not timed.
[[nodiscard]] Optimum optimize(const Scene& scene, const MotionSpace& space, const OptimizeOptions& options = {});
/// `optimize` over the motions of Eq. 6.
[[nodiscard]] Optimum optimize(const Scene& scene, const SeaParameters<double>& sea,
                               const OptimizeOptions& options = {});

}  // namespace ukemi::landing

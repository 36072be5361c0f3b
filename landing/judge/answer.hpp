// The complete answer to Eq. 6: the best motion, its landing and that of the held reference, the effect of small
// deviations, and whether the actuator can follow it; by a deadline, where one is given.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "landing/judge/checked.hpp"
#include "landing/judge/evidence.hpp"
#include "landing/judge/least_breaking.hpp"
#include "landing/judge/limit.hpp"
#include "landing/judge/under_scatter.hpp"
#include "landing/search/optimize.hpp"

namespace ukemi::landing {

struct Answer;

/// Limits the reference's rate, the motor's speed and its torque to the actuator's ratings. Throws InputError where
/// the actuator lacks one of them.
void respect_ratings(const Actuator& actuator, OptimizeOptions& options);

struct AnswerOptions {
  RobustOptions robust;
  OptimizeOptions search;  ///< its deadline is that of the whole answer, output included
  /// Run in turn, each with the full number of motions, or an equal part of a deadline; empty: search.solver alone.
  std::vector<std::string> solvers;
  double rate = 0;  ///< sampling of the trajectories [Hz]; 0: none
  enum class Extras {
    kWithoutDeadline,  ///< evidence is computed where there is no deadline and landings are not too long
    kAlways,           ///< however long it takes, beyond the deadline too
  } evidence = Extras::kWithoutDeadline;
  Monitor evidence_monitor;  ///< progress in the evidence's landings
  double used = 0;           ///< time of the deadline spent before the call [s]
  double kept_back = 0;      ///< time of the deadline reserved for the caller's output [s]
};

struct Answer {
  Scene scene;
  Actuator actuator;
  AnswerOptions options;
  Optimum best;
  std::vector<Optimum> tried;  ///< the result of each solver
  /// The landings of best.motion and best.held; End::kStopped where there was no time to play them.
  Landing landing, held;
  std::optional<LeastBreaking> least_breaking;  ///< where no motion was found that keeps the ratings
  std::optional<Evidence> evidence;
  std::optional<TouchdownLimit> limit;        ///< with the evidence
  double evidence_seconds = 0;                ///< time of the evidence [s]
  std::optional<Scatter> scatter;             ///< of the drops; absent: measured drops
  bool scatter_assumed = false;               ///< neither the scene nor the options have one
  bool scattered = false;                     ///< planned for scatter: best.value is the promised measure
  std::optional<UnderScatter> under_scatter;  ///< with the evidence
  std::optional<Optimum> nominal;             ///< the plan for the scene's own drop, compared with one for scatter
  std::optional<Estimated> promised;          ///< of a plan for scatter, best.value with its error; with the evidence
  std::optional<Ratings> ratings;             ///< where the landing was played
  std::optional<Instability> instability;
  bool tolerant_known = false;  ///< best.tolerant was played completely, or is the goal of the search

  bool played() const { return landing.end != End::kStopped; }
  double peak() const { return played() ? landing.peak : best.landing.peak; }  ///< [m/s^2]
  double held_peak() const;                                                    ///< [m/s^2]; NaN where it is not known
  double reduction() const { return 1 - peak() / held_peak(); }
};

/// Throws InputError on invalid options; else see Optimum::found, without which the rest is empty.
[[nodiscard]] Answer answer(const Scene& scene, const Actuator& actuator, const AnswerOptions& options = {});

}  // namespace ukemi::landing

// The answer to Eq. 6 as a robot's programmer wants it: the best motion, its landing and that of the held reference,
// what small deviations do to it, and whether the actuator can follow it; all of it by a deadline, where one is given.
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

/// Keeps the reference's rate, the motor's speed and its torque within the actuator's ratings. Throws InputError where
/// the actuator lacks one of them.
void respect_ratings(const Actuator& actuator, OptimizeOptions& options);

struct AnswerOptions {
  RobustOptions robust;
  OptimizeOptions search;  ///< its deadline is that of the whole answer, handed over
  /// Tried in turn, each with the whole number of motions, of a deadline with its part; empty: search.solver alone.
  std::vector<std::string> solvers;
  double rate = 0;  ///< rows of the trajectories a second [Hz]; 0: none
  enum class Extras {
    kWithoutDeadline,  ///< evidence is computed where there is no deadline and landings are not too long
    kAlways,           ///< whatever it takes, beyond the deadline too
  } evidence = Extras::kWithoutDeadline;
  Monitor evidence_monitor;  ///< progress in the evidence's landings
  double used = 0;           ///< of the deadline, before the call [s]
  double kept_back = 0;      ///< of the deadline, for what the caller does with the answer [s]
};

struct Answer {
  Scene scene;
  Actuator actuator;
  AnswerOptions options;
  Optimum best;
  std::vector<Optimum> tried;  ///< what each solver came to; one where one was asked for
  /// The landings of `best.motion` and of best.held; End::kStopped where there was no time to play them.
  Landing landing, held;
  std::optional<LeastBreaking> least_breaking;  ///< where nothing was found that keeps the ratings
  std::optional<Evidence> evidence;
  std::optional<TouchdownLimit> limit;        ///< with the evidence
  double evidence_seconds = 0;                ///< that it took
  std::optional<Scatter> scatter;             ///< of the drops; none: they were measured
  bool scatter_assumed = false;               ///< the scene states none, and no option does
  bool scattered = false;                     ///< planned for it: best.value is the measure that is promised
  std::optional<UnderScatter> under_scatter;  ///< with the evidence
  std::optional<Optimum> nominal;             ///< the plan for the scene's own drop, to compare with one for scatter
  std::optional<Estimated> promised;          ///< best.value of a plan for scatter, and its error; with the evidence
  std::optional<Ratings> ratings;             ///< where the landing was played
  std::optional<Instability> instability;
  bool tolerant_known = false;  ///< best.tolerant was played whole, or was what the search minimised

  bool played() const { return landing.end != End::kStopped; }
  double peak() const { return played() ? landing.peak : best.landing.peak; }  ///< [m/s^2]
  double held_peak() const;                                                    ///< [m/s^2]; NaN where it is not known
  double reduction() const { return 1 - peak() / held_peak(); }
};

/// Throws InputError on invalid options; else see Optimum::found, without which the rest is empty.
[[nodiscard]] Answer answer(const Scene& scene, const Actuator& actuator, const AnswerOptions& options = {});

}  // namespace ukemi::landing

// The best landing of a robot of links: in its own drop, within the execution tolerance, or over scattered drops.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/monitor.hpp"
#include "landing/body/body_run.hpp"
#include "landing/model/variables.hpp"
#include "landing/scatter/measure.hpp"
#include "landing/search/goal.hpp"

namespace ukemi::landing {

struct BodyDrop;

struct BodyPlanOptions {
  std::string solver = "auto";     ///< of solver_names(); "sqp" with goals that have derivatives alone
  Goal goal = Goal::kPeak;         ///< kPeak or kTolerant (the worst of execution_drops); `measure` makes it robust
  std::optional<Measure> measure;  ///< of the peaks over scattered drops; with kTolerant each is played inexactly
  std::optional<Scatter> scatter;  ///< see scatter_for
  std::shared_ptr<const std::vector<BodyDrop>> measured;  ///< drops as they were measured, instead of drawn ones
  std::optional<double> share;  ///< with a measure: of drops that must keep the limits; absent: Measure::share
  double inflate = 1;           ///< see BodyDropModel::Options
  long samples = 64;            ///< drops of the search, 1 to 4096; fewer with a short deadline
  long judging = 256;           ///< other drops, on which the best few are judged; the same range
  long fresh = 2048;  ///< further drops for the report on the answer, 0 to 1e6; with a deadline only if `share` is set
  std::optional<long> evaluations;  ///< motions, with a measure landings; absent: default_evaluations, or no bound
  std::optional<double> deadline;   ///< of the answer, from the call [s], > 0
  double accuracy = 1e-9;           ///< of the best, see SimulateOptions
  std::uint64_t seed = 1;
  int threads = 0;                 ///< 0: all cores; without influence on the results
  std::vector<BodyMotion> starts;  ///< warm starts
  double rate = 0;                 ///< sampling of the answer's trajectory [Hz]; 0: none
  Monitor monitor;
  void validate() const;  ///< throws InputError
  /// Increases by a half for each variable beyond those of the quintics.
  long default_evaluations(const BodyScene& scene) const;
};

/// An improvement of the best.
struct BodyProgress {
  long evaluations;
  double seconds, value;
};

/// A plan over fresh drops, or all measured ones, compared with the held posture.
struct BodyUnderScatter {
  std::optional<Scatter> scatter;  ///< absent: measured drops
  bool assumed = false;            ///< neither the options nor the scene have a scatter
  Distribution planned, held;
  Estimated measured;               ///< BodyPlanOptions::measure of the plan; without one the mean
  long from_floor = 0, broken = 0;  ///< drops that would begin below the floor; drops in which the plan breaks a limit
  std::vector<long> exceeded;       ///< of each of BodyScene::loads, drops in which the plan exceeds its rating
};

struct BodyPlan {
  BodyMotion motion;    ///< the best; the held posture where nothing was better
  BodyLanding landing;  ///< of `motion`, at BodyPlanOptions::accuracy
  BodyMotion hold;      ///< the posture of `held_posture`
  BodyLanding held;     ///< its landing
  double value = 0;     ///< the goal: the peak, the tolerant peak, the measure over the judging drops; NaN: none found
  double held_value = 0;                  ///< the goal of the held posture
  bool held_keeps_limits = true;          ///< false: it cannot be the answer
  std::optional<BodyUnderScatter> under;  ///< if drops scatter; with a deadline only for a share, if time is left
  std::vector<Variable> variables;
  Edges edges{};  ///< edges of the ranges on which the motion lies
  long evaluations = 0;
  double seconds = 0;                  ///< from the call to the answer, without `under`
  bool found = false;                  ///< false: not even holding could be followed to the floor
  std::string message;                 ///< why nothing was found, or why the search ended early
  std::vector<BodyProgress> progress;  ///< at kSearchAccuracy
};

/// The motion with the smallest goal that keeps BodyScene::limits and the loads that are limits: in the whole execution
/// box, with a measure in `share` of the drops. Never worse than the held posture where that keeps them. Deterministic
/// for a seed and a number of evaluations, whatever the threads; with a deadline the clock decides. Throws InputError
/// as `simulate`. Tests: test/legs/plans.cpp, scatter.cpp, loads.cpp.
[[nodiscard]] BodyPlan plan(const BodyScene& scene, const BodyPlanOptions& options = {});

}  // namespace ukemi::landing

// The best landing of a robot of any joints: in its own drop, played inexactly, or over drops that scatter. Ours.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/monitor.hpp"
#include "landing/body/body_run.hpp"
#include "landing/model/variables.hpp"
#include "landing/scatter/measure.hpp"
#include "landing/search/goal.hpp"

namespace ukemi::landing {

struct BodyPlanOptions {
  Goal goal = Goal::kPeak;         ///< kTolerant: the worst of execution_drops; kRobust is told by `measure`
  std::optional<Measure> measure;  ///< of the peaks over drops that scatter; with kTolerant each is played inexactly
  std::optional<Scatter> scatter;  ///< see scatter_for
  std::optional<double> share;     ///< with a measure: of the drops, that keep the limits; absent: Measure::share
  double inflate = 1;              ///< see BodyDropModel::Options
  long samples = 64;               ///< drops that are searched on, 1 to 4096; fewer by a short deadline
  long judging = 256;              ///< others, that the best few are judged on; the same range
  long fresh = 2048;  ///< others again, that the answer is told on, 0 to 1e6; by a deadline for `share` alone
  std::optional<long> evaluations;  ///< motions, with a measure landings; absent: default_evaluations, or all in time
  std::optional<double> deadline;   ///< when the answer stands, from the call on [s], > 0
  double accuracy = 1e-9;           ///< at which the best are judged, see SimulateOptions
  std::uint64_t seed = 1;
  int threads = 0;                 ///< 0: all cores; without influence on the results
  std::vector<BodyMotion> starts;  ///< tried before all others, and searched from
  double rate = 0;                 ///< rows of the answer's trajectory a second [Hz]; 0: none
  Monitor monitor;
  void validate() const;  ///< throws InputError
  /// Of a scene: half as many again for each variable more than the quintics have.
  long default_evaluations(const BodyScene& scene) const;
};

/// A moment at which the best became better.
struct BodyProgress {
  long evaluations;
  double seconds, value;
};

/// A plan over fresh drops, beside the held posture.
struct BodyUnderScatter {
  Scatter scatter;
  bool assumed = false;  ///< nobody said what the scatter is
  Distribution planned, held;
  Estimated measured;               ///< BodyPlanOptions::measure of the plan; without one the mean
  long from_floor = 0, broken = 0;  ///< drops that would begin below the floor; in which the plan breaks a limit
  std::vector<long> exceeded;       ///< of BodyScene::loads, the plan's drops beyond the rating
};

struct BodyPlan {
  BodyMotion motion;    ///< the best; holding where nothing was better
  BodyLanding landing;  ///< of it, at BodyPlanOptions::accuracy
  BodyMotion hold;      ///< the posture of `held_posture`
  BodyLanding held;     ///< its landing
  double value = 0;     ///< the goal: the peak, the tolerant peak, the measure over the judging drops; NaN: none found
  double held_value = 0;                  ///< the same of the held posture, judged first
  bool held_keeps_limits = true;          ///< false: holding is no answer
  std::optional<BodyUnderScatter> under;  ///< where drops scatter; by a deadline with a share and time for it
  std::vector<Variable> variables;
  Edges edges{};  ///< of the ranges that the motion lies on
  long evaluations = 0;
  double seconds = 0;                  ///< from the call to the answer, without `under`
  bool found = false;                  ///< false: not even holding could be followed to the floor
  std::string message;                 ///< why nothing was found, or why the search ended early
  std::vector<BodyProgress> progress;  ///< in the search's own accuracy
};

/// The motion with the smallest goal that keeps BodyScene::limits and the loads that are limits: in the whole execution
/// box, with a measure in `share` of the drops. Never worse than the held posture, where that keeps them. The same for
/// a seed and a number of evaluations whatever the threads; with a deadline the clock decides. Throws InputError as
/// `simulate`. Tests: test/legs/plans.cpp, scatter.cpp, loads.cpp.
[[nodiscard]] BodyPlan plan(const BodyScene& scene, const BodyPlanOptions& options = {});

}  // namespace ukemi::landing

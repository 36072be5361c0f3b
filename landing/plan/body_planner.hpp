// The search for the control program of a robot of links: repeated plans, each by a deadline.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "landing/plan/body_plan.hpp"
#include "landing/search/planner.hpp"

namespace ukemi::landing {

/// State of a robot of links measured in the air. A number out of its range, or NaN, gives Plan::Status::kBadInput.
struct BodyFallState {
  double height;                              ///< clearance of the lowest contact now, 0 to 1e4 [m]
  std::vector<BodyRelease::Joint> joints;     ///< of Robot::joints, at most 2 pi and 1e3 rad/s either way
  double forward_speed = 0;                   ///< of a free base, at most 1e3 either way [m/s]
  double pitch = 0;                           ///< theta of the first link, at most 2 pi either way [rad]
  double pitch_rate = 0;                      ///< not on a rail, at most 1e3 either way [rad/s]
  double elapsed = 0;                         ///< since release, which was at rest; 0 to 1e3 [s]
  std::optional<double> vertical_speed = {};  ///< upwards, at most 1e3 [m/s]; absent: of a free fall of `elapsed`
};

/// The answer of a BodyPlanner.
struct BodyAnswer {
  Plan::Status status = Plan::Status::kNothing;
  BodyPlan plan;      ///< times of its moves in the air count from the call
  std::string wrong;  ///< with kBadInput: the number and its rule
  bool found() const { return status == Plan::Status::kFound; }
};

/// Owns a scene and its last plan, from which the next plan of a fall starts. Not to be called from two threads at
/// once. Unlike Planner it allocates, and searches on BodyPlanOptions::threads. Tests: test/legs/air.cpp.
class BodyPlanner {
 public:
  /// Of the options `deadline` and `starts` are set by each call. Throws InputError as `plan`.
  explicit BodyPlanner(const BodyScene& scene, const BodyPlanOptions& options = {.goal = Goal::kTolerant});

  /// The best motion for a drop from rest that is found within `deadline` seconds from the call (> 0, <= 1000).
  [[nodiscard]] BodyAnswer plan(const Drop& drop, double deadline, std::uint64_t seed = 1);
  /// The same for a robot in the air, whose references stand at the measured angles until the deadline and can move
  /// from then on. No worse than holding there, where that keeps the limits. Throws nothing for bad measurements.
  [[nodiscard]] BodyAnswer plan(const BodyFallState& state, double deadline, std::uint64_t seed = 1);
  /// Warm starts of the next plan, as an atlas has them, instead of the last plan.
  void start(std::vector<BodyMotion> motions) { starts_ = std::move(motions); }
  void forget() { last_.clear(); }  ///< before a new fall: ignores the last plan

 private:
  BodyAnswer search(const BodyScene& scene, double deadline, std::uint64_t seed);

  BodyScene scene_;
  BodyPlanOptions options_;
  std::vector<BodyMotion> starts_;
  BodyMotion last_;  ///< in the air the ends of its moves count from release
};

}  // namespace ukemi::landing

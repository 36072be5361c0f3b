// The best landing of a robot of any joints: a quintic for every driven joint, one duration for all. Ours.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/monitor.hpp"
#include "landing/body/body_run.hpp"
#include "landing/model/motion_space.hpp"

namespace ukemi::landing {

/// The motions that a search may choose from: phi_I and phi_F of each driven joint in their order, then the duration.
class BodySpace {
 public:
  /// Throws InputError where no joint is driven, or more of them than kMostVariables hold.
  explicit BodySpace(const BodyScene& scene);
  int dimension() const { return int(variables_.size()); }
  /// phi_i_JOINT, phi_f_JOINT ..., duration.
  const std::vector<Variable>& variables() const { return variables_; }
  /// What a point of the unit cube stands for.
  BodyMotion motion(const Coordinates& unit) const;
  /// The place of a motion in the cube, the nearest where it lies beyond.
  Coordinates unit(const BodyMotion& motion) const;
  /// Which variables of a point lie on an edge of their range, to a thousandth of it.
  Edges edges(const Coordinates& unit) const;

 private:
  BodyMotion rest_;          ///< of joints that are not driven
  std::vector<int> driven_;  ///< indices of Robot::joints
  std::vector<Variable> variables_;
};

struct BodyPlanOptions {
  long evaluations = kDefaultEvaluations;  ///< motions that are tried in all, >= 1; with a deadline no more than these
  std::optional<double> deadline;          ///< when the answer stands, from the call on [s], > 0
  double accuracy = 1e-9;                  ///< at which the best are judged, see SimulateOptions
  std::uint64_t seed = 1;
  int threads = 0;  ///< 0: all cores; without influence on the results
  double rate = 0;  ///< rows of the answer's trajectories a second [Hz]; 0: none
  Monitor monitor;
  void validate() const;  ///< throws InputError

  static constexpr long kDefaultEvaluations = 40'000;
};

/// A moment at which the best became better.
struct BodyProgress {
  long evaluations;
  double seconds, value;
};

struct BodyPlan {
  BodyMotion motion;    ///< the best; holding where nothing was better
  BodyLanding landing;  ///< of it, at BodyPlanOptions::accuracy
  BodyMotion hold;      ///< the posture of `held_posture`
  BodyLanding held;     ///< its landing, judged first
  std::vector<Variable> variables;
  Edges edges{};  ///< of the ranges that the motion lies on
  long evaluations = 0;
  double seconds = 0;                  ///< from the call to the answer
  bool found = false;                  ///< false: not even holding could be followed to the floor
  std::string message;                 ///< why nothing was found, or why the search ended early
  std::vector<BodyProgress> progress;  ///< in the search's own accuracy
};

/// The motion with the smallest peak of the robot's point. The held posture comes first, and the answer is never worse.
/// Scouts from anywhere, then covariance adaptation (landing/search) by turns from the best places and from anywhere;
/// the best few are judged at a tight accuracy. The same for a seed and a number of evaluations whatever the number of
/// threads; with a deadline the clock decides. Throws InputError as `simulate`. Tests: test/legs/plans.cpp.
[[nodiscard]] BodyPlan plan(const BodyScene& scene, const BodyPlanOptions& options = {});

}  // namespace ukemi::landing

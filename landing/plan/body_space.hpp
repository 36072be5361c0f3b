// The search space of motions of a robot of links: a quintic for every driven joint, with shape terms and gains where
// the scene has them.
#pragma once

#include <vector>

#include "landing/body/body_scene.hpp"
#include "landing/derivatives/body_gradient.hpp"
#include "landing/model/motion_space.hpp"

namespace ukemi::landing {

/// Of a base that falls freely, downwards; 0 of a pinned one [m/s^2].
double fall_acceleration(const Robot& robot);
/// Time until touchdown with fixed joints and without rotation; infinite where nothing falls [s].
double fall_time(const BodyScene& scene);

/// Variables: phi_I and phi_F of each driven joint in their order, the duration (with BodyScene::own_durations one for
/// each), then what BodyScene::freedom adds to each joint: shape terms, gains.
class BodySpace {
 public:
  /// Throws InputError where no joint is driven, or for more than kMaxVariables variables.
  explicit BodySpace(const BodyScene& scene);
  int dimension() const { return int(variables_.size()); }
  /// phi_i_JOINT, phi_f_JOINT ..., duration, b0_JOINT ..., gain_p_JOINT ...; with a release `to`, one for all joints.
  const std::vector<Variable>& variables() const { return variables_; }
  /// The motion of a point of the unit cube.
  BodyMotion motion(const Coordinates& unit) const;
  /// The point of a motion in the cube, the nearest one where it lies outside.
  Coordinates unit(const BodyMotion& motion) const;
  /// A point with phi_F = phi_I of each joint, all else as of the held posture.
  Coordinates held(Coordinates unit) const;
  /// The variables' values at a point of the cube, and the inverse: the nearest point in it, 0.5 for a range of one
  /// value.
  Coordinates values(const Coordinates& unit) const;
  Coordinates unit(const Coordinates& values) const;
  /// The parameters of a landing that the variables are, in their order.
  std::vector<BodyParameter> parameters() const;
  /// Which variables lie on an edge of their range, to a thousandth of it.
  Edges edges(const Coordinates& unit) const;

 private:
  BodyMotion base_;  ///< the held posture, with the release: what the variables do not set
  /// The number of a motion that a variable sets.
  struct Slot {
    int joint;   ///< of Robot::joints; -1: of all driven ones
    int number;  ///< index in motion_numbers
  };
  void add(int joint, int number, const Variable& variable);

  std::vector<int> driven_;  ///< indices of Robot::joints
  std::vector<Slot> slots_;
  std::vector<Variable> variables_;
};

}  // namespace ukemi::landing

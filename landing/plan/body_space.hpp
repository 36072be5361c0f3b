// The motions of a robot of any joints that a search may choose from: a quintic for every driven joint, and what the
// scene lets it have beside. Ours.
#pragma once

#include <vector>

#include "landing/body/body_scene.hpp"
#include "landing/derivatives/body_gradient.hpp"
#include "landing/model/motion_space.hpp"

namespace ukemi::landing {

/// How long a robot falls whose joints stand and that does not turn; infinite where nothing falls [s].
double fall_time(const BodyScene& scene);

/// The motions that a search may choose from: phi_I and phi_F of each driven joint in their order, the duration (with
/// BodyScene::own_durations of each), then what BodyScene::freedom adds to each joint: shape terms, gains.
class BodySpace {
 public:
  /// Throws InputError where no joint is driven, or more of them than kMostVariables hold.
  explicit BodySpace(const BodyScene& scene);
  int dimension() const { return int(variables_.size()); }
  /// phi_i_JOINT, phi_f_JOINT ..., duration, b0_JOINT ..., gain_p_JOINT ...; with a release `to`, one for all joints.
  const std::vector<Variable>& variables() const { return variables_; }
  /// What a point of the unit cube stands for.
  BodyMotion motion(const Coordinates& unit) const;
  /// The place of a motion in the cube, the nearest where it lies beyond.
  Coordinates unit(const BodyMotion& motion) const;
  /// A point's motion that stays where it starts: phi_F as phi_I, all else as of the held posture.
  Coordinates held(Coordinates unit) const;
  /// The variables' values at a point of the cube, and back: the nearest place in it; a range of one value has its
  /// middle.
  Coordinates values(const Coordinates& unit) const;
  Coordinates unit(const Coordinates& values) const;
  /// What each variable is to a landing, in their order.
  std::vector<BodyParameter> parameters() const;
  /// Which variables of a point lie on an edge of their range, to a thousandth of it.
  Edges edges(const Coordinates& unit) const;

 private:
  BodyMotion rest_;  ///< of joints that are not driven; of those that are, their release
  /// Which number of motion_numbers of which joint a variable is.
  struct Slot {
    int joint;  ///< of Robot::joints; -1: of all that are driven
    int number;
  };
  void add(int joint, int number, const Variable& variable);

  std::vector<int> driven_;  ///< indices of Robot::joints
  std::vector<Slot> slots_;
  std::vector<Variable> variables_;
};

}  // namespace ukemi::landing

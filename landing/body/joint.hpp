// A joint of the hybrid system: the constants of its drive in a scalar, and its mode.
#pragma once

#include "common/sea.hpp"
#include "landing/body/robot.hpp"
#include "landing/model/motion.hpp"

namespace ukemi::landing {

/// Constants of the drive of a joint.
template <class T>
struct JointConstants {
  DriveKind kind = DriveKind::kElastic;
  SeaParameters<T> sea{T(0), T(0), T(0), T(0), T(1)};
  T stiffness{0}, damping{0}, rest{0};  ///< passive
  T parallel_stiffness{0}, parallel_rest{0};
  T inverse_i_motor{1};  ///< see BodySystem::complete_constants

  bool extended = false;                    ///< friction, or a spring that stiffens
  std::array<bool, kSides> has_friction{};  ///< by side: dry friction, or derivatives by it

  template <class Other>
  void copy_structure(const Other& o) {
    kind = o.kind, sea.feedback = o.sea.feedback, extended = o.extended, has_friction = o.has_friction;
  }
  template <class Other>
  bool same_structure(const Other& o) const {
    return kind == o.kind && sea.feedback == o.sea.feedback && extended == o.extended && has_friction == o.has_friction;
  }
  /// Calls f(constant of a, same constant of b) for every constant.
  template <class A, class B, class F>
  static void for_each(A& a, const B& b, F&& f) {
    SeaParameters<T>::for_each(a.sea, b.sea, f);
    f(a.stiffness, b.stiffness), f(a.damping, b.damping), f(a.rest, b.rest);
    f(a.parallel_stiffness, b.parallel_stiffness), f(a.parallel_rest, b.parallel_rest);
    f(a.inverse_i_motor, b.inverse_i_motor);
  }
};

struct JointMode {
  int saturation = 0;              ///< of the spring's torque or the geared motor's: -1, 0, 1
  std::array<int, kSides> slip{};  ///< by side with dry friction: sign of its rate; 0: it sticks
  Phase phase = Phase::kBefore;
};

}  // namespace ukemi::landing

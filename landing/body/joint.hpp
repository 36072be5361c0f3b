// A joint as the system sees it: its drive in a scalar, and what is held between events.
#pragma once

#include "common/sea.hpp"
#include "landing/body/robot.hpp"
#include "landing/model/motion.hpp"

namespace ukemi::landing {

/// The drive of a joint in its scalar.
template <class T>
struct JointConstants {
  DriveKind kind = DriveKind::kElastic;
  SeaParameters<T> sea{T(0), T(0), T(0), T(0), T(1)};
  T stiffness{0}, damping{0}, rest{0};  ///< passive
  T parallel_stiffness{0}, parallel_rest{0};

  bool extended = false;            ///< it has friction, or a spring that stiffens
  std::array<bool, kSides> rubs{};  ///< a side has dry friction, or derivatives by it are needed

  template <class Other>
  void take_structure(const Other& o) {
    kind = o.kind, sea.feedback = o.sea.feedback, extended = o.extended, rubs = o.rubs;
  }
  template <class Other>
  bool same_structure(const Other& o) const {
    return kind == o.kind && sea.feedback == o.sea.feedback && extended == o.extended && rubs == o.rubs;
  }
  /// f(a's, b's) of every constant.
  template <class A, class B, class F>
  static void for_each(A& a, const B& b, F&& f) {
    SeaParameters<T>::for_each(a.sea, b.sea, f);
    f(a.stiffness, b.stiffness), f(a.damping, b.damping), f(a.rest, b.rest);
    f(a.parallel_stiffness, b.parallel_stiffness), f(a.parallel_rest, b.parallel_rest);
  }
};

struct JointMode {
  int saturation = 0;              ///< of the spring's torque, or of the geared motor's
  std::array<int, kSides> slip{};  ///< of a side with dry friction: the sign of its motion, or 0 where it is stuck
  Phase phase = Phase::kBefore;
};

}  // namespace ukemi::landing

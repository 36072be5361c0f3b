// A robot that is driven by a log's commands: angles, rates and reported torques of its joints, at given times.
//
// Fixed steps of the classical Runge-Kutta method, as many to each command between two of the times, so that what comes
// out depends smoothly on every number of the robot: differences are derivatives. Touchdowns and lift-offs, and the
// sticking and sliding of contacts, joints, motors and rail, are found within their step, which is parted there.
// Ours. Tests: test/legs/driven.cpp.
#pragma once

#include "landing/body/command_path.hpp"
#include "landing/driven/contact_change.hpp"
#include "landing/driven/driven_log.hpp"

namespace ukemi::landing {

struct DrivenOptions {
  double step = 0;                   ///< the longest, > 0; 0: stable_step [s]
  long most = 2'000'000;             ///< steps of one run
  bool loads = false;                ///< accelerations and forces are sampled too, at a derivative a time
  const Sensors* sensors = nullptr;  ///< of the pushes; what is sampled is what is, not what they say; none: exact
};

/// A step over which no joint decays or turns by more than what the method follows, at most 1 ms: from the acceleration
/// that a torque on each joint alone gives, its damping, the fall of its friction with speed, and its stiffness; of a
/// robot with contacts at most 0.2 ms [s]. Runs whose difference is a derivative need the same.
[[nodiscard]] double stable_step(const Robot& robot, const CommandPath& path, const Commands& commands,
                                 const DrivenStart& start);

struct DrivenRollout {
  /// Of Robot::joints, then by Sensed: one a time.
  std::vector<std::array<std::vector<double>, kSensed>> joint;
  std::array<std::vector<double>, kBaseSensed> base;          ///< of a free base, one a time
  std::array<std::vector<double>, kBodySensed> acceleration;  ///< likewise [m/s^2]; empty: not sampled
  std::vector<std::array<std::vector<double>, 2>> force;      ///< of Robot::contacts, on the robot [N]; likewise
  std::vector<ContactChange> changes;                         ///< in their order; those that touch at the start first
  bool complete = false;  ///< every time has its values: no state left the range of numbers or of the joints
  long steps = 0;
};

/// From `start`, at times.front() to the last of `times` [the clock of `commands`, increasing]. Torque, acceleration
/// and forces at a time are those of the command in force before it.
[[nodiscard]] DrivenRollout roll_driven(const Robot& robot, const CommandPath& path, const Commands& commands,
                                        const DrivenStart& start, const std::vector<double>& times,
                                        const DrivenOptions& options = {});

}  // namespace ukemi::landing

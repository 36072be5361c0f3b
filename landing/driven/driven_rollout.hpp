// A robot driven by the commands of a log: angles, rates and reported torques of its joints, at given times.
//
// Fixed steps of the classical Runge-Kutta method, equally many for each command between two times, so that the result
// is a smooth function of every number of the robot and can be differentiated by differences. Touchdowns, lift-offs,
// sticking and sliding are located within their step, which is split there. Ours. Tests: test/legs/driven.cpp.
#pragma once

#include "landing/body/command_path.hpp"
#include "landing/driven/contact_change.hpp"
#include "landing/driven/driven_log.hpp"

namespace ukemi::landing {

struct DrivenOptions {
  double step = 0;                   ///< maximum step, > 0; 0: stable_step [s]
  long max_steps = 2'000'000;        ///< of one run
  bool loads = false;                ///< also sample accelerations and forces; costs a derivative per time
  const Sensors* sensors = nullptr;  ///< of the pushes only: samples are true values; null: exact
};

/// A stable and accurate step, at most 1 ms, with contacts at most 0.2 ms [s]: from each joint's inverse inertia, its
/// damping, its stiffness, and the fall of its friction with speed. Runs that are differenced need the same step.
[[nodiscard]] double stable_step(const Robot& robot, const CommandPath& path, const Commands& commands,
                                 const DrivenStart& start);

struct DrivenRollout {
  /// Of Robot::joints, then by JointSignal: one value per time.
  std::vector<std::array<std::vector<double>, kJointSignals>> joint;
  std::array<std::vector<double>, kBaseSignals> base;                  ///< of a free base, one value per time
  std::array<std::vector<double>, kAccelerationSignals> acceleration;  ///< one per time [m/s^2]; empty: not sampled
  std::vector<std::array<std::vector<double>, 2>> force;  ///< of Robot::contacts, on the robot [N]; as acceleration
  std::vector<ContactChange> changes;                     ///< in order; contacts that touch at the start first
  bool complete = false;  ///< every time has values; else the state diverged or max_steps were exceeded
  long steps = 0;
};

/// The trial from `start` at times.front() to times.back() [clock of `commands`, increasing]. Torque, acceleration and
/// forces at a time are those of the command in force before it.
[[nodiscard]] DrivenRollout roll_driven(const Robot& robot, const CommandPath& path, const Commands& commands,
                                        const DrivenStart& start, const std::vector<double>& times,
                                        const DrivenOptions& options = {});

}  // namespace ukemi::landing

// When contacts touch and leave: read from the force of a log and of the rollout that follows it, by one rule, and how
// far the two are apart.
//
// A contact touches where the force across the floor rises through a level, and leaves where it falls below half of
// that. The level is a twentieth of the largest force of that contact in the logs, at most a fifth of the robot's
// weight and at least six standard deviations of the log's noise. A flight shorter than kShortestFlight is none: the
// contact chatters. Times are on the line between two rows. What the rule is late by is late in the log and in the
// rollout alike.
//
// No printing, no files. Tests: test/legs/contact_times.cpp.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "tools/study/robot_trials.hpp"

namespace ukemi::tools {

inline constexpr double kShortestFlight = 0.01;  ///< [s]

/// How a contact stands once, t from the trial's first row [s]; NaN: before the first row, behind the last.
struct Stance {
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  double touchdown = kUnknown, liftoff = kUnknown;
  double left = kUnknown;  ///< its liftoff before

  double duration() const { return liftoff - touchdown; }
  double flight() const { return touchdown - left; }
};
/// The level by the largest force of a contact, the robot's weight (0: none) and six standard deviations of the noise
/// (NaN: not known) [N]. After a hard landing the weight alone is still a stance.
double stance_level(double largest, double weight, double noise);
/// Of a force on the contact across the floor [N], a row a time; rows that are not finite are left out. level > 0.
std::vector<Stance> stances(const std::vector<double>& t, const std::vector<double>& force, double level);

/// A stance of a log beside that of the rollout that shares most of its time. Each is once in the list: where there is
/// no other, all of that is NaN.
struct ComparedStance {
  std::size_t trial = 0;
  int contact = 0;  ///< of Robot::contacts
  bool in_log = false, in_rollout = false;
  Stance measured, predicted;
  /// Halves of the 95 % bands that the constants' errors promise of the rollout [s]; NaN: not known.
  double touchdown_band = Stance::kUnknown, duration_band = Stance::kUnknown, flight_band = Stance::kUnknown;
  /// Means of the other stances of this contact in the logs, two at least [s]; else NaN.
  double duration_of_others = Stance::kUnknown, flight_of_others = Stance::kUnknown;
};
/// Of each contact whose force across the floor (f_CONTACT_y) the logs have.
std::vector<ComparedStance> compared_stances(const DrivenRobot& robot, const std::vector<RobotTrial>& trials,
                                             const FloorFit& followed);

/// Means over the landings where both are known; NaN: over none.
struct TimeErrors {
  int count = 0;
  double absolute = Stance::kUnknown;  ///< of predicted less measured [s]
  double relative = Stance::kUnknown;  ///< over the measured; of durations alone
  double others = Stance::kUnknown;    ///< relative, of the mean of the other landings in place of the rollout
  double within = Stance::kUnknown;    ///< share within the band
};
struct StanceErrors {
  int contact = 0;
  int measured = 0, missed = 0, added = 0;  ///< stances in the logs; those without one in the rollout; the other way
  TimeErrors touchdown, duration, flight;
};
/// Of each contact that the logs have a force of, in its order.
std::vector<StanceErrors> stance_errors(const DrivenRobot& robot, const std::vector<RobotTrial>& trials,
                                        const std::vector<ComparedStance>& compared);

}  // namespace ukemi::tools

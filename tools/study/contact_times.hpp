// Touchdown and lift-off times of contacts, by the same rule from the forces of a log and of its rollout, and the
// differences between the two.
//
// A contact touches where the force normal to the floor rises through a threshold, and leaves where it falls below half
// of it. The threshold is 1/20 of the contact's largest force in the logs, at most 1/5 of the robot's weight and at
// least six standard deviations of the log's noise. A flight shorter than kShortestFlight is chatter and not counted.
// Times are interpolated between rows. The delay of the rule is the same in log and rollout.
//
// No printing, no files. Tests: test/legs/contact_times.cpp.
#pragma once

#include <limits>
#include <vector>

#include "tools/study/robot_trials.hpp"

namespace ukemi::tools {

inline constexpr double kShortestFlight = 0.01;  ///< [s]

/// One stance of a contact, times from the trial's first row [s]; NaN: before the first row or after the last.
struct Stance {
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  double touchdown = kUnknown, liftoff = kUnknown;
  double previous_liftoff = kUnknown;

  double duration() const { return liftoff - touchdown; }
  double flight() const { return touchdown - previous_liftoff; }
};
/// The threshold [N] from a contact's largest force, the robot's weight (0: unknown) and six standard deviations of the
/// noise (NaN: not known). The bound by the weight lets quiet standing after a hard landing count as stance.
double stance_threshold(double largest, double weight, double noise);
/// The stances in a normal force [N] at times t; rows that are not finite are skipped. threshold > 0.
std::vector<Stance> stances(const std::vector<double>& t, const std::vector<double>& force, double threshold);

/// A stance of a log and the rollout's stance with the longest overlap. Each appears once; without a partner the other
/// is NaN.
struct ComparedStance {
  std::size_t trial = 0;
  int contact = 0;  ///< of Robot::contacts
  bool in_log = false, in_rollout = false;
  Stance measured, predicted;
  /// Half-widths of the rollout's 95 % bands due to the constants' errors [s]; NaN: not known.
  double touchdown_band = Stance::kUnknown, duration_band = Stance::kUnknown, flight_band = Stance::kUnknown;
  /// Means over the other stances of this contact in the logs, at least two [s]; else NaN.
  double duration_of_others = Stance::kUnknown, flight_of_others = Stance::kUnknown;
};
/// The stances of each contact whose normal force (f_CONTACT_y) is logged.
std::vector<ComparedStance> compared_stances(const DrivenRobot& robot, const std::vector<RobotTrial>& trials,
                                             const FloorFit& followed);

/// Means over the stances where both times are known; NaN: none.
struct TimeErrors {
  int count = 0;
  double absolute = Stance::kUnknown;  ///< of |predicted - measured| [s]
  double relative = Stance::kUnknown;  ///< of |predicted - measured| / measured; durations only
  double others = Stance::kUnknown;    ///< as relative, with the mean of the other stances as prediction
  double within = Stance::kUnknown;    ///< fraction within the band
};
struct StanceErrors {
  int contact = 0;
  int measured = 0, missed = 0, added = 0;  ///< stances in the logs, in the logs only, in the rollout only
  TimeErrors touchdown, duration, flight;
};
/// Errors of each contact whose normal force is logged, in the robot's order.
std::vector<StanceErrors> stance_errors(const DrivenRobot& robot, const std::vector<RobotTrial>& trials,
                                        const std::vector<ComparedStance>& compared);

}  // namespace ukemi::tools

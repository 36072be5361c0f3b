// Which commands to log next of a robot of links: of candidates, those whose logs will tell most of the constants. The
// information of each is that of the fit (floor_fit.hpp): Fisher's, of its rollout at the present constants, for the
// noise of each channel, how the trial starts eliminated. Errors to come are those of white residuals: a model that
// lacks something has larger ones.
//
// No printing, no files: tools/verbs/design_robot.cpp is the verb. Tests: test/legs/robot_design.cpp.
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "identify/design/information.hpp"
#include "tools/study/robot_trials.hpp"

namespace ukemi::tools {

struct RobotDesignOptions {
  RobotFitOptions fit;  ///< terms: what is fitted, with starts as nuisance
  identify::Criterion criterion = identify::Criterion::kWorst;
  int trials = 2;  ///< that are chosen, at least 1
  /// Standard deviations by channel of sensed_channels, as "torque_hip": those that are logged next, in place of what
  /// the trials in hand say. One of each unit as theirs, "phi", "dphi", "torque", serves all joints.
  std::map<std::string, double> noise;
};

/// A candidate, beside what is in hand and the candidates that were chosen before it.
struct NextTrial {
  std::string file;
  bool followed = false;       ///< false: the robot cannot be simulated so; nothing below holds
  double alone = 0;            ///< the criterion with what is in hand and this one
  Eigen::VectorXd half_width;  ///< of each constant then, 95 %, see RobotDesign
  int rank = 0;                ///< 1: the best to log next; 0: not chosen
  double together = 0;         ///< of a chosen one: the criterion with all those of lower rank
};

struct RobotDesign {
  identify::Criterion criterion = identify::Criterion::kWorst;
  int in_hand = 0;  ///< trials
  std::vector<std::string> constants, units;
  Eigen::VectorXd value;  ///< of the robot as it is given
  /// What an error is told in parts of: the value, or the size that a constant which may be 0 is judged by.
  Eigen::VectorXd part_of;
  Eigen::VectorXd before, after;           ///< 95 % half-widths in these parts, infinite where not determined
  double size_before = 0, size_after = 0;  ///< the criterion
  std::vector<NextTrial> candidates;       ///< in the order that they were given
  std::vector<landing::DropChannel> channels;
  std::vector<double> noise;  ///< of each channel that is logged; NaN: it is not
  /// Where the trials in hand leave more than their noise: errors to come are larger than these then.
  std::vector<std::string> doubts;
};

/// The terms of trials and candidates together, see robot_terms; of the candidates every channel that `noise` names is
/// logged (RobotDesignOptions), and without trials in hand what the robot's fit logged.
identify::Terms<DropTerm> design_terms(const DrivenRobot& robot, std::vector<RobotTrial> in_hand,
                                       const std::vector<RobotTrial>& candidates,
                                       const std::map<std::string, double>& noise);

/// Each candidate from each height of its lowest contact over the floor [m], at rest, as its name says; without heights
/// as they are. Throws InputError where one is below 0 or the base is pinned.
std::vector<RobotTrial> from_heights(const DrivenRobot& robot, const std::vector<RobotTrial>& candidates,
                                     const std::vector<double>& heights);

/// A log that holds commands and what is measured before them as the trial that they will be: every channel with a
/// noise has a place in every row, and it starts at rest where its first row says, an angle that is not measured at its
/// command. Throws InputError where nothing says it.
RobotTrial planned_trial(const DrivenRobot& robot, const RobotTrial& commands, const std::vector<double>& noise);

/// Chooses among candidates one after the other, each that which makes the criterion smallest beside those before it. A
/// faint prior, a standard deviation of a hundred parts, lets sets be compared that leave something open. Where
/// trials in hand are none, what the robot's file knows counts (DrivenRobot::known), its noise too. Throws InputError.
[[nodiscard]] RobotDesign design_trials(const DrivenRobot& robot, const std::vector<RobotTrial>& in_hand,
                                        const std::vector<RobotTrial>& candidates, const RobotDesignOptions& options);

}  // namespace ukemi::tools

// Design of the next experiment on a robot of links: of candidate commands, those whose logs give the most information
// on the constants. It is the Fisher information of the fit (floor_fit.hpp): of the rollout at the present constants,
// for the noise of each channel, the trial's start eliminated. Predicted errors assume white residuals: an incomplete
// model has larger ones.
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
  RobotFitOptions fit;  ///< its terms: the constants, with the starts as nuisance terms
  identify::Criterion criterion = identify::Criterion::kWorst;
  int trials = 2;  ///< number of candidates to choose, at least 1
  /// Standard deviations of the next logs by channel of sensed_channels, as "torque_hip"; they override those of the
  /// trials in hand. "phi", "dphi", "torque" alone are for all joints.
  std::map<std::string, double> noise;
};

/// A candidate, evaluated with the trials in hand and the candidates of lower rank.
struct CandidateTrial {
  std::string file;
  bool followed = false;       ///< false: it cannot be simulated; what follows is not valid
  double alone = 0;            ///< the criterion with the trials in hand and this one
  Eigen::VectorXd half_width;  ///< 95 %, of each constant in parts of RobotDesign::scale, then
  int rank = 0;                ///< 1: the first to log; 0: not chosen
  double together = 0;         ///< if chosen: the criterion with those of lower rank too
};

struct RobotDesign {
  identify::Criterion criterion = identify::Criterion::kWorst;
  int in_hand = 0;  ///< number of trials
  std::vector<std::string> constants, units;
  Eigen::VectorXd value;  ///< of the constants of the given robot
  /// Scale of each constant's errors: |value|, or a typical size of a constant that may be 0.
  Eigen::VectorXd scale;
  Eigen::VectorXd before, after;           ///< 95 % half-widths over `scale`, infinite where not determined
  double size_before = 0, size_after = 0;  ///< the criterion
  std::vector<CandidateTrial> candidates;  ///< in the given order
  std::vector<landing::DropChannel> channels;
  std::vector<double> noise;  ///< of each channel; NaN: not logged
  /// Residuals of the trials in hand above their noise: errors will be larger than predicted.
  std::vector<std::string> doubts;
};

/// The terms of trials and candidates together, see robot_terms. The candidates log every channel that `noise` names
/// (RobotDesignOptions) and, without trials in hand, those of the robot's fit.
identify::Terms<DropTerm> design_terms(const DrivenRobot& robot, std::vector<RobotTrial> in_hand,
                                       const std::vector<RobotTrial>& candidates,
                                       const std::map<std::string, double>& noise);

/// Each candidate, started at rest from each height of its lowest contact over the floor [m], which its name then
/// states; the candidates themselves without heights. Throws InputError where one is below 0 or the base is pinned.
std::vector<RobotTrial> from_heights(const DrivenRobot& robot, const std::vector<RobotTrial>& candidates,
                                     const std::vector<double>& heights);

/// The trial that a log of commands will give: every channel with a noise has a value in every row. It starts at rest
/// at the log's first measured values, or an angle at its first command. Throws InputError where neither is there.
RobotTrial planned_trial(const DrivenRobot& robot, const RobotTrial& commands, const std::vector<double>& noise);

/// Chooses candidates greedily: each minimises the criterion together with those before it. A weak prior, of standard
/// deviation 100 scales, makes sets comparable that leave a constant undetermined. Without trials in hand the
/// uncertainty and noise of the robot's file count (DrivenRobot::known). Throws InputError.
[[nodiscard]] RobotDesign design_trials(const DrivenRobot& robot, const std::vector<RobotTrial>& in_hand,
                                        const std::vector<RobotTrial>& candidates, const RobotDesignOptions& options);

}  // namespace ukemi::tools

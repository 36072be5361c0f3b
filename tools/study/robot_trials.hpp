// Simulated trials of a robot driven by a log's commands, as a function of the fitted terms: any number of the robot by
// its path in the files, the command path, and each trial's start. The fit is that of floor_fit.hpp; derivatives are
// finite differences of a rollout with fixed steps (landing/driven).
//
// No printing, no files: tools/verbs/identify_robot.cpp is the verb. Tests: test/legs/driven.cpp.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "landing/body/body_scene.hpp"
#include "landing/body/robot_file.hpp"
#include "landing/driven/driven_rollout.hpp"
#include "tools/study/floor_fit.hpp"

namespace ukemi::tools {

/// A robot with its command path and sensors.
struct DrivenRobot {
  landing::BodyScene scene;
  landing::CommandPath path;
  landing::Sensors sensors = {};
  std::optional<FitUncertainty> known = {};  ///< by names of terms: [identified] of the file, which a fit writes
};
/// Reads a robot file, or that of a scene file. Throws InputError with file:line:column, and where trials do not
/// support the robot. `texts` replace the content of files, by path.
DrivenRobot read_driven_robot(const std::string& path, const landing::Texts& texts = {});

/// A trial: its measurements, and the commands of the whole log.
struct RobotTrial {
  landing::DropLog log;  ///< of sensed_channels; t counts from the first row
  double origin = 0;     ///< time of the first row in the log's clock [s]
  std::string run;       ///< the file that it comes from
  /// Height of the lowest contact over its surface at the first row [m]; absent: the one that fits the log best.
  std::optional<double> height = {};
  std::vector<std::string> notes = {};  ///< on the first trial of a file: warnings about its columns and gaps
  std::shared_ptr<const landing::Commands> commands;
};
std::vector<const landing::DropLog*> logs_of(const std::vector<RobotTrial>& trials);
/// The files that they come from, each once, in order.
std::vector<std::string> runs_of(const std::vector<RobotTrial>& trials);
/// The measured_columns of a robot as channels.
std::vector<landing::DropChannel> sensed_channels(const landing::Robot& robot);
/// Index of the first channel of a joint, of the base (after the last joint), and of acc.
constexpr std::size_t joint_channel(std::size_t joint) { return landing::kJointSignals * joint; }
inline std::size_t base_channel(const landing::Robot& robot) { return joint_channel(robot.joints.size()); }
inline std::size_t acceleration_channel(const landing::Robot& robot) {
  return base_channel(robot) + (robot.base == landing::Base::kFree ? std::size_t(landing::kBaseSignals) : 0);
}

struct RobotLogOptions {
  std::string columns;  ///< NAME=COLUMN,..., as for trials of a rig
  double pieces = 0;    ///< approximate length of the trials that the log is cut into [s]; 0: not cut
  /// Or times to cut at, in the log's clock [s], increasing; rows before the first and after the last are left out.
  std::vector<double> times;
  /// Or, for a robot that hops on a rail, kHops: cut in each push-off, where the driven leg extends through the middle
  /// of its range. A piece is the end of a push-off, a flight and a landing.
  enum class Cuts { kGiven, kHops } cuts = Cuts::kGiven;
  int tied = 1;  ///< number of consecutive pieces that are joined to one trial, >= 1
  enum class Angles { kOneTurn, kMultiTurn } angles = Angles::kOneTurn;
  enum class Measured { kAngles, kNothing } measured = Measured::kAngles;  ///< required columns
};
/// Reads a log (CSV): t [s], phi_JOINT [rad] of every joint that is not locked; where they are logged dphi_JOINT,
/// torque_JOINT (reported) and the other sensed_channels, and of driven joints the commands phi_ref_JOINT,
/// dphi_ref_JOINT, torque_ff_JOINT, k_p_JOINT, k_d_JOINT, on_JOINT; of each push of the robot push_NAME_x or
/// push_NAME_y, or both [N]. A measured cell may be empty, a command's not.
/// Throws InputError with file:line:column.
std::vector<RobotTrial> read_robot_trials(const std::string& path, const landing::Robot& robot,
                                          const RobotLogOptions& options);

/// Removes channels that are constant over all trials, unless they are angles or positions: of a missing sensor, or a
/// contact that never touches. Returns a warning for each.
std::vector<std::string> remove_flat_columns(const landing::Robot& robot, std::vector<RobotTrial>& trials);

/// Warnings about implausible contact forces, before remove_flat_columns: 0 throughout a log where others have them, a
/// wrong sign, a wrong unit.
std::vector<std::string> force_doubts(const DrivenRobot& robot, const std::vector<RobotTrial>& trials);

/// The terms of a robot and its trials: drive.JOINT.KEY, robot.link.LINK.KEY (link.LINK.KEY for short),
/// robot.gravity, command.delay, command.JOINT.KEY, sensor.COLUMN.gain and sensor.COLUMN.bias of what is logged,
/// sensor.time_shift and sensor.push_smooth of pushes; then, for each trial, start.JOINT.phi, start.JOINT.dphi and
/// start.JOINT.spring, added to the log's first values, and of a base that is not pinned start.height and
/// start.speed (DrivenStart); of a free one start.pitch, start.pitch_rate, start.forward_speed and start.x too.
/// By default no constant and every start is fitted. A centre of mass is bounded along its link by the outermost places
/// (joint, children's joints, contacts, pushes, the point that counts), across it by a quarter of the link's length
/// beyond them. An inertia is bounded by that of the whole mass at the link's ends.
identify::Terms<DropTerm> robot_terms(const DrivenRobot& robot, const std::vector<RobotTrial>& trials);

struct RobotFitOptions : CalibrationOptions {
  RobotFitOptions() { restarts = 0; }
  int threads = 0;              ///< of the differences; 0: all cores; results do not depend on it
  landing::DrivenOptions roll;  ///< of the rollout
  double difference = 1e-6;     ///< relative step of the differences; ten times that with contacts
};

/// Replaces these fitted constants by one for each run: NAME@1 of the first file of the trials, and so on, with the
/// bounds, priors and profiles of NAME. The fitted robot has their mean; their uncertainty for a further run includes
/// the scatter between runs. Throws InputError where one is not fitted.
void fit_per_run(const std::vector<std::string>& names, const std::vector<RobotTrial>& trials,
                 RobotFitOptions& options);

/// The value of the robot's number with this name. Throws InputError where there is none.
double number_of(const DrivenRobot& robot, const std::string& name);
/// Sets the numbers of a term to `value`.
void set_in(DrivenRobot& robot, const DropTerm& term, double value);

/// Keeps references to its arguments.
class RobotTrials : public DropSimulator {
 public:
  RobotTrials(const DrivenRobot& robot, const std::vector<RobotTrial>& trials, const RobotFitOptions& options);

  LogsOf logs_of() const override { return LogsOf::kTrials; }
  std::vector<double> horizons() const override;
  const std::vector<landing::DropChannel>& channels() const override { return channels_; }
  std::size_t drops() const override { return trials_.size(); }
  const landing::DropLog& log(std::size_t m) const override { return trials_[m].log; }
  double value(const DropTerm& constant) const override;
  double first_touchdown(std::size_t) const override { return 0; }
  FollowedDrop follow(std::size_t m, const Settings& settings, const std::vector<double>& times,
                      const landing::SimulateOptions& options) const override;
  bool differentiate(std::size_t m, const Settings& settings, const std::vector<double>& times,
                     const landing::SimulateOptions& options, FollowedDrop& followed) const override;
  double work_factor(std::size_t settings) const override { return 100 * double(1 + settings); }
  double peak(std::size_t, const Settings&, double, const landing::SimulateOptions&) const override;

 private:
  /// Robot and start of a trial for given terms.
  struct Setup {
    DrivenRobot robot;
    landing::DrivenStart start;
  };
  void guess_height(std::size_t m);
  bool acts_on(std::size_t m, const DropTerm& term) const { return term.run < 0 || term.run == run_[m]; }
  /// Absent where the numbers are not physical.
  std::optional<Setup> set_up(std::size_t m, const Settings& settings) const;
  /// The actual values; `logged` applies gain and bias of the sensors.
  FollowedDrop roll(std::size_t m, const Setup& setup, const std::vector<double>& times,
                    const landing::DrivenOptions& requested = {}) const;
  double step_of(std::size_t m, const Setup& setup) const;
  FollowedDrop logged(FollowedDrop actual, const landing::Sensors& sensors) const;
  /// Index of the channel with this name, and of the channel whose sensor a term belongs to.
  std::optional<std::size_t> channel(const std::string& name) const;
  std::optional<std::size_t> sensed_by(const DropTerm& term) const;

  const DrivenRobot& robot_;
  const std::vector<RobotTrial>& trials_;
  const RobotFitOptions& options_;
  std::vector<landing::DropChannel> channels_;
  std::vector<landing::DrivenStart> start_;  ///< of each trial, from its log
  std::vector<int> run_;                     ///< index of each trial's run
  std::map<std::string, std::function<void(landing::BodyScene&, double)>> setters_;
};

struct RobotFit : FloorFit {
  DrivenRobot robot;  ///< the given one with the fitted constants
};
/// Fits the constants of the options; none is trusted where the residuals reject the robot. Throws InputError as
/// fit_floor does.
[[nodiscard]] RobotFit fit_robot(const DrivenRobot& robot, const std::vector<RobotTrial>& trials,
                                 const RobotFitOptions& options);
/// Simulates the trials with the robot's constants; only each trial's start is fitted. With prediction bands where the
/// robot's uncertainty is known.
[[nodiscard]] RobotFit predict_robot(const DrivenRobot& robot, const std::vector<RobotTrial>& trials,
                                     const RobotFitOptions& options);

}  // namespace ukemi::tools

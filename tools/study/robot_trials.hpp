// Trials of a robot that is driven by a log's commands, as a function of a fit's terms: any number of the robot by its
// way in the files, what its commands pass through, and how each trial starts. The fit is that of floor_fit.hpp, its
// derivatives are differences of a rollout with fixed steps (landing/driven).
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

/// A robot, what its commands pass through and how its sensors read.
struct DrivenRobot {
  landing::BodyScene scene;
  landing::CommandPath path;
  landing::Sensors sensors = {};
  std::optional<Identified> known = {};  ///< by the names of terms: [identified] of the file, which a fit writes
};
/// Of a file of a robot, or of a scene that has one. Throws InputError with file:line:column, and where trials have no
/// law for it. `texts` stand in place of files, by their paths.
DrivenRobot read_driven_robot(const std::string& path, const landing::Texts& texts = {});

/// A trial: what was measured from its first row on, and the commands of the whole log.
struct RobotTrial {
  landing::DropLog log;  ///< of sensed_channels; t counts from the first row
  double origin = 0;     ///< what the log's clock read there [s]
  std::string run;       ///< the file that it is of
  /// At its first row, of the lowest contact over its surface [m]; none: where its log fits best.
  std::optional<double> height = {};
  std::vector<std::string> notes = {};  ///< of the file's first trial: columns that are not read and look like others
  std::shared_ptr<const landing::Commands> commands;
};
std::vector<const landing::DropLog*> logs_of(const std::vector<RobotTrial>& trials);
/// The files that they are of, each once, in their order.
std::vector<std::string> runs_of(const std::vector<RobotTrial>& trials);
/// The measured_columns of a robot.
std::vector<landing::DropChannel> sensed_channels(const landing::Robot& robot);
/// Where those of a joint begin among them, of the first link (behind the last joint), and acc.
constexpr std::size_t joint_channel(std::size_t joint) { return landing::kSensed * joint; }
inline std::size_t base_channel(const landing::Robot& robot) { return joint_channel(robot.joints.size()); }
inline std::size_t acceleration_channel(const landing::Robot& robot) {
  return base_channel(robot) + (robot.base == landing::Base::kFree ? std::size_t(landing::kBaseSensed) : 0);
}

struct RobotLogOptions {
  std::string columns;  ///< NAME=COLUMN,..., as of trials of a rig
  double pieces = 0;    ///< the log is cut into trials about so long [s]; 0: it is not
  /// Or at these, in the log's clock [s], increasing; what is before and behind them is left out.
  std::vector<double> times;
  /// Or, of a robot on a rail that hops, in each push: where the leg extends through the middle of its range, its
  /// joints driving. A piece is the push's end, a flight and a landing.
  enum class Cuts { kGiven, kHops } cuts = Cuts::kGiven;
  int tied = 1;  ///< so many pieces that follow each other are one: the next begins where the one before ends; >= 1
  enum class Angles { kOneTurn, kMultiTurn } angles = Angles::kOneTurn;
  enum class Measured { kAngles, kNothing } measured = Measured::kAngles;  ///< what must be there
};
/// Reads a log (CSV): t [s], phi_JOINT [rad] of every joint that is not locked; where they are logged dphi_JOINT,
/// torque_JOINT (reported) and the other sensed_channels, and of driven joints the commands phi_ref_JOINT,
/// dphi_ref_JOINT, torque_ff_JOINT, k_p_JOINT, k_d_JOINT, on_JOINT; of each push of the robot push_NAME_x or
/// push_NAME_y, or both [N]. A measured cell may be empty, a command's not.
/// Throws InputError with file:line:column.
std::vector<RobotTrial> read_robot_trials(const std::string& path, const landing::Robot& robot,
                                          const RobotLogOptions& options);

/// Takes away what a column says that says the same in every row of every trial, unless it is an angle or a place: of a
/// sensor that is not there, or a contact that never touches. A warning of each.
std::vector<std::string> leave_out_still(const landing::Robot& robot, std::vector<RobotTrial>& trials);

/// What looks wrong with the forces of contacts, before still columns are taken away: a log in which one is 0
/// throughout where others have it, a sign, a unit. A warning of each.
std::vector<std::string> force_doubts(const DrivenRobot& robot, const std::vector<RobotTrial>& trials);

/// What can be fitted of a robot on such trials: drive.JOINT.KEY, robot.link.LINK.KEY (link.LINK.KEY for short),
/// robot.gravity, command.delay, command.JOINT.KEY, sensor.COLUMN.gain and sensor.COLUMN.bias of what is logged,
/// sensor.time_shift and sensor.push_smooth of pushes; then, a trial each, start.JOINT.phi, start.JOINT.dphi and
/// start.JOINT.spring, added to what the log says, and of a base that is not pinned those of DrivenStart: start.height
/// and start.speed; of a free one start.pitch, start.pitch_rate, start.forward_speed and start.x too.
/// Chosen: no constant, every start. A centre of mass stays within its link: along it between its outermost places
/// (joint, children's joints, contacts, pushes, the point that counts), across it up to a quarter of its length beside
/// them. An inertia stays below that of all its mass at the link's ends.
identify::Terms<DropTerm> robot_terms(const DrivenRobot& robot, const std::vector<RobotTrial>& trials);

struct RobotFitOptions : CalibrationOptions {
  RobotFitOptions() { restarts = 0; }
  int threads = 0;              ///< of the differences; 0: all cores; without influence on the results
  landing::DrivenOptions roll;  ///< of the rollout
  double difference = 1e-6;     ///< step of the differences, of a term's size; of a robot with contacts ten times that
};

/// Each run has these fitted constants for its own: NAME@1 of the first file of the trials, and so on, with the bounds,
/// priors and profiles of NAME. The fitted robot has their mean; of a run to come they are known as the runs scatter.
/// Throws InputError where one is not fitted.
void give_each_run(const std::vector<std::string>& names, const std::vector<RobotTrial>& trials,
                   RobotFitOptions& options);

/// A number of it by the name of its term. Throws InputError where there is none.
double number_of(const DrivenRobot& robot, const std::string& name);
/// The robot with terms at their values.
void set_in(DrivenRobot& robot, const DropTerm& term, double value);

/// What it is made from must outlive it.
class RobotTrials : public DropSimulator {
 public:
  RobotTrials(const DrivenRobot& robot, const std::vector<RobotTrial>& trials, const RobotFitOptions& options);

  LogsOf logs_of() const override { return LogsOf::kTrials; }
  std::vector<double> parts() const override;
  const std::vector<landing::DropChannel>& channels() const override { return channels_; }
  std::size_t drops() const override { return trials_.size(); }
  const landing::DropLog& log(std::size_t m) const override { return trials_[m].log; }
  double value(const DropTerm& constant) const override;
  double first_touchdown(std::size_t) const override { return 0; }
  FollowedDrop follow(std::size_t m, const Settings& settings, const std::vector<double>& times,
                      const landing::SimulateOptions& options) const override;
  bool differentiate(std::size_t m, const Settings& settings, const std::vector<double>& times,
                     const landing::SimulateOptions& options, FollowedDrop& followed) const override;
  double patience(std::size_t settings) const override { return 100 * double(1 + settings); }
  double peak(std::size_t, const Settings&, double, const landing::SimulateOptions&) const override;

 private:
  /// What terms at their values make of a trial; none where no matter has such numbers.
  struct Posed {
    DrivenRobot robot;
    landing::DrivenStart start;
  };
  void guess_height(std::size_t m);
  bool has(std::size_t m, const DropTerm& term) const { return term.run < 0 || term.run == run_[m]; }
  std::optional<Posed> pose(std::size_t m, const Settings& settings) const;
  /// As it is; `logged`: as the sensors say.
  FollowedDrop roll(std::size_t m, const Posed& posed, const std::vector<double>& times,
                    const landing::DrivenOptions& asked = {}) const;
  double step_of(std::size_t m, const Posed& posed) const;
  FollowedDrop logged(FollowedDrop actual, const landing::Sensors& sensors) const;
  /// Of its name, if it is one; and whose sensor a term is.
  std::optional<std::size_t> channel(const std::string& name) const;
  std::optional<std::size_t> sensed_by(const DropTerm& term) const;

  const DrivenRobot& robot_;
  const std::vector<RobotTrial>& trials_;
  const RobotFitOptions& options_;
  std::vector<landing::DropChannel> channels_;
  std::vector<landing::DrivenStart> start_;  ///< of each trial, as its log says
  std::vector<int> run_;                     ///< that each trial is of
  std::map<std::string, std::function<void(landing::BodyScene&, double)>> setters_;
};

struct RobotFit : FloorFit {
  DrivenRobot robot;  ///< the given one with the fitted constants
};
/// Fits the constants that the options name; none is trusted where the residuals speak against the robot. Throws
/// InputError as fit_floor.
[[nodiscard]] RobotFit fit_robot(const DrivenRobot& robot, const std::vector<RobotTrial>& trials,
                                 const RobotFitOptions& options);
/// The trials for the robot's constants; only how each starts is fitted. Where it is known how well these are known,
/// with what that promises.
[[nodiscard]] RobotFit predict_robot(const DrivenRobot& robot, const std::vector<RobotTrial>& trials,
                                     const RobotFitOptions& options);

}  // namespace ukemi::tools

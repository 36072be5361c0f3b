// The verbs that demo and others call. Each computes and writes its files; `result`, unless null, receives the result.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "landing/body/robot_file.hpp"
#include "landing/judge/answer.hpp"
#include "tools/program/output.hpp"
#include "tools/program/trials.hpp"
#include "tools/report/identify.hpp"
#include "tools/study/comparison.hpp"
#include "tools/verbs/exporting.hpp"
#include "tools/verbs/freedom.hpp"
#include "tools/verbs/given_motion.hpp"
#include "tools/verbs/scattering.hpp"

namespace ukemi::tools {

struct IdentifyArguments {
  std::vector<std::string> trials;
  std::string rig, start, actuator;  ///< start: identify; actuator: predict
  std::string robot;                 ///< robot of links, instead of the rig
  std::string pieces;                ///< of its logs: auto, [s], or FILE[:COLUMN] of times
  int tie = 1;                       ///< number of pieces that form a trial
  std::vector<std::string> given;    ///< names of the options on the command line
  std::string start_angle;           ///< predict: [rad], or "fit"
  std::string per_run;               ///< those of `free` with a value for each log
  std::string free, nuisance, prior, errors, lower, upper, loss = "none";
  identify::FitOptions::Weights weights = identify::FitOptions::Weights::kEqual;
  TrialArguments reading;
  std::optional<double> speed_max, motor_torque_max;  ///< the motor's ratings, override the rig's
  double accuracy = 1e-9;
  int starts = 0;  ///< number to explore; 0: as few as needed
  Doubt doubt = Doubt::kReport;
  identify::TrustOptions::Depth depth = identify::TrustOptions::Depth::kResiduals;
  std::string profile;  ///< constants, comma-separated
  std::string scene;    ///< of the landing whose peak the fit's errors move
  MotionArguments motion;
  Exports exports;
};
/// Fits, or predicts if `actuator` is set.
int run_identify(const IdentifyArguments& arguments, const CommonOptions& common);
enum class Predicts { kNo, kYes };
/// Fits or predicts for a robot of links.
int identify_robot(const IdentifyArguments& arguments, const CommonOptions& common, Predicts predicts);

/// The path of a file in a folder.
inline std::string in(const std::string& folder, const char* name) {
  return (std::filesystem::path(folder) / name).string();
}

/// Logs of a robot of links to compare a plan with.
struct LogArguments {
  std::vector<std::string> files;
  std::string columns, pieces;
  int tie = 1;
};
/// For each trial of the logs the largest acceleration of the point that counts, simulated under the log's commands
/// from a fitted start [m/s^2]. `texts` replace the content of the robot's files, by path.
std::vector<double> logged_peaks(const std::string& robot, const landing::Texts& texts, const LogArguments& logs,
                                 const CommonOptions& common, Run& run);

/// The scene of a verb for both kinds of robot.
struct SceneArguments {
  std::string scene;
  std::vector<std::string> actuators, set;  ///< FILE or JOINT=FILE; KEY=VALUE
  std::optional<double> height;             ///< of the drop, instead of the scene's
};
struct OptimizeArguments : SceneArguments {
  std::string solver = "auto";
  landing::Goal goal = landing::Goal::kPeak;
  std::optional<long> evaluations;
  std::optional<double> deadline;
  double tolerance = 0;
  std::vector<std::string> forbid;
  enum class Ratings { kReport, kRespect } ratings = Ratings::kReport;
  landing::AnswerOptions::Extras evidence = landing::AnswerOptions::Extras::kWithoutDeadline;
  double rate = 1000;
  FreedomArguments freedom;
  std::optional<std::string> robust;  ///< a measure
  ScatterArguments scatter;
  std::optional<long> samples;
  std::optional<double> share;  ///< fraction of the drops that keep the limits
  std::optional<double> penalty;
  LogArguments logs;
  Exports exports;
  CommonOptions::Lines lines = CommonOptions::Lines::kAnswer;
};
int run_optimize(const OptimizeArguments& arguments, const CommonOptions& common);

struct CompareArguments {
  std::vector<std::string> nominal, identified;  ///< one file each; of a robot of links one for each joint
  std::string scene, rig;
  std::vector<std::string> trials;
  TrialArguments reading;
  std::optional<std::string> robust;  ///< a measure
  ScatterArguments scatter;
  std::optional<long> evaluations;  ///< of each search
};
int run_compare(const CompareArguments& arguments, const CommonOptions& common, Comparison* result = nullptr);

}  // namespace ukemi::tools

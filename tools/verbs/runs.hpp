// The verbs that the demo runs one after the other. Each computes and writes its files; `result` receives what it
// found.
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
  std::string robot;                 ///< of links, in place of the rig
  std::string pieces;                ///< of its logs: [s], or FILE[:COLUMN] of times
  int tie = 1;                       ///< so many of them are one trial
  std::vector<std::string> given;    ///< the options that were
  std::string start_angle;           ///< predict: [rad], or "fit"
  std::string per_run;               ///< of `free`, those that each log has for its own
  std::string free, nuisance, prior, errors, lower, upper, loss = "none";
  identify::FitOptions::Weights weights = identify::FitOptions::Weights::kEqual;
  TrialArguments reading;
  std::optional<double> speed_max, motor_torque_max;  ///< the motor's ratings, before the rig's
  double accuracy = 1e-9;
  int starts = 0;  ///< explored; 0: as few as needed
  Doubt doubt = Doubt::kReport;
  identify::TrustOptions::Depth depth = identify::TrustOptions::Depth::kResiduals;
  std::string profile;  ///< constants, at commas
  std::string scene;    ///< of the landing whose peak the fit's errors move
  MotionArguments motion;
  Exports exports;
};
/// Fits, or with `actuator` set predicts.
int run_identify(const IdentifyArguments& arguments, const CommonOptions& common);
enum class Predicts { kNo, kYes };
/// The same of a robot of links.
int identify_robot(const IdentifyArguments& arguments, const CommonOptions& common, Predicts predicts);

/// A file of a folder.
inline std::string in(const std::string& folder, const char* name) {
  return (std::filesystem::path(folder) / name).string();
}

/// Logs of a robot of links that a plan stands beside.
struct LogArguments {
  std::vector<std::string> files;
  std::string columns, pieces;
  int tie = 1;
};
/// Of each of their trials the largest acceleration of the point that counts, by the robot's model under the log's
/// commands [m/s^2]; how each starts is fitted to it. `texts` stand in place of its files.
std::vector<double> logged_peaks(const std::string& robot, const landing::Texts& texts, const LogArguments& logs,
                                 const CommonOptions& common, Run& run);

struct OptimizeArguments {
  std::string scene;
  std::vector<std::string> set;  ///< KEY=VALUE
  std::vector<std::string> actuators;
  std::optional<double> height;  ///< of the drop, instead of the scene's
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
  std::optional<double> share;  ///< of the drops, that keep the limits
  std::optional<double> penalty;
  LogArguments logs;
  Exports exports;
  CommonOptions::Lines lines = CommonOptions::Lines::kAnswer;
};
int run_optimize(const OptimizeArguments& arguments, const CommonOptions& common);
/// Of a deadline, what the results take to be written at most [s].
double writing_time(double deadline);
/// --samples of a plan for drops that scatter; none: as many as usual. Throws InputError.
std::optional<long> scattered_samples(const OptimizeArguments& arguments);

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

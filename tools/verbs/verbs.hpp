// The verbs of the program: each adds its subcommand and, when chosen, its action.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/actuator.hpp"
#include "identify/fit/fit.hpp"
#include "landing/judge/evidence.hpp"
#include "landing/search/optimize.hpp"
#include "tools/program/output.hpp"
#include "tools/program/trials.hpp"
#include "tools/report/trust.hpp"

namespace ukemi::tools {

using Action = std::function<int()>;

/// -o, --json, --threads, --seed, --quiet, --no-report.
void add_common(CLI::App& verb, CommonOptions& options);

void add_identify(CLI::App& app, Action& chosen);  // identify, predict
void add_simulate(CLI::App& app, Action& chosen);
void add_optimize(CLI::App& app, Action& chosen);
void add_calibrate(CLI::App& app, Action& chosen);
void add_compare(CLI::App& app, Action& chosen);
void add_design(CLI::App& app, Action& chosen);
void add_demo(CLI::App& app, Action& chosen);
void add_map(CLI::App& app, Action& chosen);
void add_bench(CLI::App& app, Action& chosen);  // integrators, identify, optimizers, stability, scenes

struct IdentifyArguments {
  std::vector<std::string> trials;
  std::string rig, start, actuator;  ///< start: identify; actuator: predict
  std::string free, nuisance, prior, lower, upper, loss = "none", weights = "equal";
  TrialArguments reading;
  double accuracy = 1e-9;
  int starts = 0;        ///< explored; 0: as few as needed
  TrustArguments trust;  ///< identify
};
/// Fits (or, with `actuator` set, predicts) and writes the verb's files. `fitted` receives the result.
int run_identify(const IdentifyArguments& arguments, const CommonOptions& common, Actuator* fitted = nullptr);

struct OptimizeArguments {
  std::string scene, actuator, solver = "auto";
  landing::Goal goal = landing::Goal::kPeak;
  std::optional<long> evaluations;
  std::optional<double> deadline;
  double tolerance = 0;
  std::vector<std::string> forbid;
  enum class Ratings { kReport, kRespect } ratings = Ratings::kReport;
  enum class Extras { kWithoutDeadline, kAlways } evidence = Extras::kWithoutDeadline;
  double rate = 1000;
};
int run_optimize(const OptimizeArguments& arguments, const CommonOptions& common, landing::Optimum* best = nullptr);

struct CompareArguments {
  std::string nominal, identified, scene, rig;
  std::vector<std::string> trials;
  TrialArguments reading;
  std::optional<landing::Optimum> identified_best;  ///< where it is known already
};
int run_compare(const CompareArguments& arguments, const CommonOptions& common, Json* summary = nullptr);

/// Where a robot could not follow a motion: the actuator's ratings against its demands.
Json ratings(const landing::Motion& motion, const landing::Landing& landing, const Actuator& actuator, Run& run);

/// Warns where the drive is unstable on the robot in flight, at the angles of the motion.
void warn_if_unstable(const landing::Scene& scene, const Actuator& actuator, const landing::Motion& motion, Run& run);

/// The words for an outcome, and JSON pieces that several verbs write.
std::string failure(const landing::LandingPeak& landing);
Json evidence_json(const landing::Evidence& evidence);
Json motion_json(const landing::Motion& motion);
Json contacts_json(const landing::Landing& landing);
Json peaks_json(const landing::Landing& landing);
std::string order_of(const landing::Landing& landing);  ///< "foot, knee, hip"; chatter left out

}  // namespace ukemi::tools

// What simulate, optimize, risk, compare and map do with a robot of links, and the verb that shows one.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "landing/body/robot_file.hpp"
#include "landing/judge/map.hpp"
#include "landing/plan/body_drops.hpp"
#include "landing/plan/body_plan.hpp"
#include "tools/verbs/runs.hpp"

namespace ukemi::tools {

/// The one file of --actuator that the paper's robot has. Throws InputError where there is none, or more.
std::string only_actuator(const std::vector<std::string>& given, const std::string& option = "--actuator");

/// FILE, or JOINT=FILE; the text before '=' is a joint's name, not a path.
std::vector<landing::GivenDrive> drives_of(const std::vector<std::string>& given,
                                           const std::string& option = "--actuator");
/// --height, checked.
std::optional<double> checked_height(const std::optional<double>& height);
/// The scene with the drives that are given, dropped from `height` where one is given; its files are inputs of the run,
/// which warns of what looks wrong. With `set`, KEY=VALUE each, the scene that the edited files hold, which the run
/// keeps.
landing::BodyScene body_of(const std::string& path, const std::vector<std::string>& actuators, Run& run,
                           const std::string& option = "--actuator", const std::optional<double>& height = {},
                           const std::vector<std::string>& set = {});
/// --actuator of a verb that takes the paper's robot too.
void add_actuators(CLI::App& verb, std::vector<std::string>& actuators);
/// --set of a verb.
void add_set(CLI::App& verb, std::vector<std::string>& set);
/// Throws InputError where it is given with the paper's robot.
void refuse_set(const std::vector<std::string>& set);
/// The files of a scene with what --set says. Throws InputError with its place.
landing::Texts edited_texts(const std::string& path, const std::vector<std::string>& actuators,
                            const std::optional<double>& height, const std::vector<std::string>& set);
/// Throws InputError where an option is given that a robot of links does not have; the message lists what it has.
void refuse(bool given, const char* option);
/// Likewise a release of the joint, which a robot of links does not have; else what else a plan may have.
void apply_freedom(const FreedomArguments& arguments, landing::BodyScene& scene, Run& run);
/// Warns where two drives differ in more than their constants.
void warn_of_feedback(Feedback nominal, Feedback identified, const std::string& joint, Run& run);
/// What optimize and trade plan: the scene with its drives, what a motion may be, what must not touch. Throws
/// InputError for options that robots of links do not have.
landing::BodyScene scene_to_plan(const OptimizeArguments& arguments, Run& run);
/// The limits of --respect-ratings; warns of drives without ratings.
void keep_ratings(landing::BodyScene& scene, Run& run);
/// How: goal, effort and scatter, seed and threads; without deadline, rate and monitor.
landing::BodyPlanOptions plan_options(const OptimizeArguments& arguments, const CommonOptions& common,
                                      const landing::BodyScene& scene, Run& run);
/// Their --scatter; their --inflate, checked.
std::optional<landing::Scatter> scatter_of(const ScatterArguments& arguments);
double inflate_of(const ScatterArguments& arguments, const landing::BodyScene& scene, Run& run);

struct SimulateArguments {
  std::string scene, drop_from;
  std::vector<std::string> set;  ///< KEY=VALUE
  std::optional<double> height;
  std::vector<std::string> actuators;
  MotionArguments motion;
  std::optional<double> rate, accuracy;
  Exports exports;
};
struct RiskArguments {
  std::string scene;
  std::vector<std::string> set;  ///< KEY=VALUE
  std::vector<std::string> actuators;
  MotionArguments motion;
  ScatterArguments scatter;
  std::optional<long> samples;
  enum class Execution { kExact, kInexact } execution = Execution::kExact;
  std::vector<std::string> forbid;
};
struct MapArguments {
  std::string scene, slice, vary;
  std::vector<std::string> set;  ///< KEY=VALUE
  std::vector<std::string> actuators;
  std::vector<int> grid;  ///< of the paper's robot; empty: its default
  FreedomArguments freedom;
  int polish = landing::MapOptions().polished;
};
struct TradeArguments {
  OptimizeArguments plan;  ///< of each design
  std::vector<std::string> vary, merge;
  std::string pareto, shard;
};
/// Their --samples, checked.
long samples_of(const RiskArguments& arguments);
int simulate_body(const SimulateArguments& arguments, const CommonOptions& common);
int risk_body(const RiskArguments& arguments, const CommonOptions& common);
int optimize_body(const OptimizeArguments& arguments, const CommonOptions& common);
int map_body(const MapArguments& arguments, const CommonOptions& common);
int run_trade(const TradeArguments& arguments, const CommonOptions& common);
int compare_body(const CompareArguments& arguments, const CommonOptions& common);

}  // namespace ukemi::tools

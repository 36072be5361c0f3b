// simulate, optimize, risk, compare and map of a robot of links, the verb `robot`, and their shared options.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/error.hpp"
#include "landing/body/robot_file.hpp"
#include "landing/judge/map.hpp"
#include "landing/plan/body_drops.hpp"
#include "landing/plan/body_plan.hpp"
#include "tools/verbs/runs.hpp"

namespace ukemi::tools {

/// The file of --actuator for the paper's robot. Throws InputError unless there is exactly one.
std::string only_actuator(const std::vector<std::string>& given, const std::string& option = "--actuator");

/// Parses FILE or JOINT=FILE; JOINT holds no '/', '\' or '.'.
std::vector<landing::GivenDrive> drives_of(const std::vector<std::string>& given,
                                           const std::string& option = "--actuator");
/// Checks --height.
std::optional<double> checked_height(const std::optional<double>& height);
/// Reads a scene with the given drives and, if given, height. Its files become inputs of the run; warns of what looks
/// wrong in it. With `set`, each KEY=VALUE, the scene of the files so edited, which become results of the run.
landing::BodyScene body_of(const std::string& path, const std::vector<std::string>& actuators, Run& run,
                           const std::string& option = "--actuator", const std::optional<double>& height = {},
                           const std::vector<std::string>& set = {});
/// Adds --actuator of a verb for both kinds of robot.
void add_actuators(CLI::App& verb, std::vector<std::string>& actuators);
/// Adds --set.
void add_set(CLI::App& verb, std::vector<std::string>& set);
/// Throws InputError where --set is given: for the paper's robot.
void refuse_set(const std::vector<std::string>& set);
/// The files of a scene as edited by --set. Throws InputError with the place in the file.
landing::Texts edited_texts(const std::string& path, const std::vector<std::string>& actuators,
                            const std::optional<double>& height, const std::vector<std::string>& set);
/// Throws InputError where an option is `given` that robots of links do not support.
/// Applies --bumps, --landing-gains and --release-... to the scene. Throws InputError.
void apply_freedom(const FreedomArguments& arguments, landing::BodyScene& scene, Run& run);
/// Warns where two drives differ in their feedback.
void warn_of_feedback(Feedback nominal, Feedback identified, const std::string& joint, Run& run);
/// The scene that optimize and trade plan for, with its drives, variables of the motion and forbidden contacts. Throws
/// InputError for options that robots of links do not support.
landing::BodyScene scene_to_plan(const OptimizeArguments& arguments, Run& run);
/// Adds the limits of --respect-ratings to the scene; warns of drives without ratings.
void keep_ratings(landing::BodyScene& scene, Run& run);
/// Search options: goal, effort, scatter, seed and threads; without deadline, rate and monitor.
landing::BodyPlanOptions plan_options(const OptimizeArguments& arguments, const CommonOptions& common,
                                      const landing::BodyScene& scene, Run& run);
/// The drops of --drops; null without it. Throws InputError where what draws drops is given too.
std::shared_ptr<const std::vector<landing::BodyDrop>> measured_drops(const ScatterArguments& arguments,
                                                                     const landing::BodyScene& scene, Run& run);
/// Parse --scatter, and check --inflate.
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
  std::vector<int> grid;  ///< paper's robot only; empty: default
  FreedomArguments freedom;
  int polish = landing::MapOptions().polished;
};
struct TradeArguments {
  OptimizeArguments plan;  ///< of each design
  std::vector<std::string> vary, merge;
  std::vector<std::string> vary_options = {};  ///< which options gave `vary`; empty: --vary
  std::string pareto, shard;
};
/// Parses FILE:ROW of --drop-from.
std::pair<std::string, std::size_t> drop_row(const std::string& text);
/// The drop of --drop-from; `read`: the drops of a file.
template <class Read>
auto drop_from(const std::string& text, Read&& read, Run& run) {
  const auto [file, row] = drop_row(text);
  run.input(file);
  const auto drops = read(file);
  if (row > drops.size())
    throw InputError(fmt::format("--drop-from: {}: the file has {} row(s)", ukemi::quoted(text), drops.size()));
  return drops[row - 1];
}
/// Checks --samples.
long samples_of(const RiskArguments& arguments);
int simulate_body(const SimulateArguments& arguments, const CommonOptions& common);
int risk_body(const RiskArguments& arguments, const CommonOptions& common);
int optimize_body(const OptimizeArguments& arguments, const CommonOptions& common);
int map_body(const MapArguments& arguments, const CommonOptions& common);
int run_trade(const TradeArguments& arguments, const CommonOptions& common);
int compare_body(const CompareArguments& arguments, const CommonOptions& common);

}  // namespace ukemi::tools

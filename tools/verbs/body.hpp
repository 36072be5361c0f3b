// What verbs of robots of links share: reading of scenes, options; --actuator and --set of both kinds of robot.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "landing/body/robot_file.hpp"
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
inline landing::BodyScene body_of(const SceneArguments& a, Run& run) {
  return body_of(a.scene, a.actuators, run, "--actuator", a.height, a.set);
}
/// Adds SCENE, --actuator and --set.
void add_scene(CLI::App& verb, SceneArguments& arguments);
/// Adds --actuator.
void add_actuators(CLI::App& verb, std::vector<std::string>& actuators);
/// Adds --set.
void add_set(CLI::App& verb, std::vector<std::string>& set);
/// Throws InputError where --set is given: for the paper's robot.
void refuse_set(const std::vector<std::string>& set);
/// The files of a scene as edited by --set. Throws InputError with the place in the file.
landing::Texts edited_texts(const SceneArguments& arguments);
/// Applies --bumps, --landing-gains and --release-... to the scene. Throws InputError.
void apply_freedom(const FreedomArguments& arguments, landing::BodyScene& scene, Run& run);
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
/// --samples of a plan for drops that scatter; absent: the default. Throws InputError.
std::optional<long> scattered_samples(const OptimizeArguments& arguments);
/// Parse --scatter, and check --inflate.
std::optional<landing::Scatter> scatter_of(const ScatterArguments& arguments);
double inflate_of(const ScatterArguments& arguments, const landing::BodyScene& scene, Run& run);

struct TradeArguments {
  OptimizeArguments plan;  ///< of each design
  std::vector<std::string> vary, merge;
  std::vector<std::string> vary_options = {};  ///< which options gave `vary`; empty: --vary
  std::string pareto, shard;
};
int run_trade(const TradeArguments& arguments, const CommonOptions& common);

}  // namespace ukemi::tools

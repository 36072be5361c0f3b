// ukemi simulate.
#include <fmt/format.h>

#include <memory>

#include "common/error.hpp"
#include "common/text.hpp"
#include "landing/body/robot_file.hpp"
#include "landing/judge/checked.hpp"
#include "landing/judge/under_scatter.hpp"
#include "landing/model/scene_file.hpp"
#include "landing/plan/body_drop_file.hpp"
#include "landing/plan/checked_body.hpp"
#include "landing/scatter/drop_file.hpp"
#include "tools/program/actuators.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/verb.hpp"
#include "tools/report/body.hpp"
#include "tools/report/results.hpp"
#include "tools/verbs/body.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

struct SimulateArguments : SceneArguments {
  std::string drop_from;
  MotionArguments motion;
  std::optional<double> rate, accuracy;
  Exports exports;
};

/// The drop of --drop-from, FILE:ROW; `read`: the drops of a file.
template <class Read>
auto drop_from(const std::string& text, Read&& read, Run& run) {
  const std::size_t colon = text.rfind(':');
  const std::size_t row =
      colon == std::string::npos ? 0 : parsed_number<std::size_t>(text.substr(colon + 1)).value_or(0);
  if (row < 1) throw InputError(fmt::format("--drop-from: {}: FILE:ROW is needed, 1 the first row", quoted(text)));
  const std::string file = text.substr(0, colon);
  run.input(file);
  const auto drops = read(file);
  if (row > drops.size())
    throw InputError(fmt::format("--drop-from: {}: the file has {} row(s)", quoted(text), drops.size()));
  return drops[row - 1];
}

int simulate_body(const SimulateArguments& a, const CommonOptions& common) {
  Run run(kSimulateOutputs, common);
  BodyScene scene = body_of(a, run);
  check_exports(a.exports, scene.robot);
  BodyMotion motion = motion_of(scene, a.motion, run);
  if (!a.drop_from.empty()) {
    const BodyDrop drop = drop_from(
        a.drop_from, [&](const std::string& path) { return read_drops(path, scene); }, run);
    motion = drop.played(motion), scene = drop.scene;
  }
  const double rate = checked_rate(a.rate.value_or(1000));
  SimulateOptions options;
  options.accuracy = a.accuracy.value_or(options.accuracy);
  options.validate();
  const CheckedBody checked = checked_body(scene, motion, options, rate);
  return report(checked, common.figures_wanted() ? held_landing(checked, rate) : std::nullopt, a.exports, run);
}

int run_simulate(const SimulateArguments& a, const CommonOptions& common) {
  if (is_of_links(a.scene)) return simulate_body(a, common);
  refuse_set(a.set);
  const std::string file = only_actuator(a.actuators);
  Run run(kSimulateOutputs, common);
  Scene scene = scene_of(a.scene, run);
  scene.drop.height = checked_height(a.height).value_or(scene.drop.height);
  Actuator actuator = rated_actuator_of(file, run);
  Motion motion = motion_of(a.motion, "simulate", run);
  const double rate = checked_rate(a.rate.value_or(1000));
  SimulateOptions options;
  options.accuracy = a.accuracy.value_or(options.accuracy);
  options.validate();
  if (!a.drop_from.empty()) {
    const ScatteredDrop drop = drop_from(
        a.drop_from, [&](const std::string& path) { return read_drops(path, scene, actuator.sea); }, run);
    const DrivenMotion play = drop.played({motion, actuator.sea});
    scene = drop.scene, motion = play.motion, actuator.sea = play.sea;
  }
  const CheckedLanding checked = checked_landing(scene, actuator, motion, options, rate);
  const auto held = common.figures_wanted() ? held_landing(checked, actuator.sea, rate) : std::nullopt;
  return report(checked, actuator, held, a.exports, run);
}

void add_simulate(CLI::App* verb, Action& chosen) {
  auto args = std::make_shared<SimulateArguments>();
  add_scene(*verb, *args);
  add_motion(*verb, args->motion);
  verb->add_option("--drop-from", args->drop_from, "FILE:ROW, a drop as risk.csv has it in place of the scene's");
  verb->add_option("--height", args->height, "drop from this height instead [m]; SCENE may be a robot of links alone");
  verb->add_option("--rate", args->rate, "rows of trajectory.csv a second [1000 Hz]");
  verb->add_option("--accuracy", args->accuracy, "relative tolerance of each step [1e-9]");
  add_export(*verb, args->exports, landing_exports());
  add_action<SimulateArguments>(*verb, args, "ukemi simulate scene.toml --actuator actuator.toml --hold -45 -o out",
                                chosen, run_simulate);
}

const Verb simulate_verb(VerbGroup::kLandings, "simulate",
                         "one landing: released, in flight, through its contacts, to rest", add_simulate);

}  // namespace

}  // namespace ukemi::tools

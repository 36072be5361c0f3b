// ukemi simulate.
#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "common/error.hpp"
#include "landing/judge/checked.hpp"
#include "landing/model/scene_file.hpp"
#include "tools/program/actuators.hpp"
#include "tools/report/results.hpp"
#include "tools/verbs/verbs.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

struct SimulateArguments {
  std::string scene, actuator, motion;
  std::optional<double> hold, rate, accuracy;
};

Motion motion_of(const SimulateArguments& a, Run& run) {
  if (a.hold) {
    if (!std::isfinite(*a.hold) || std::abs(*a.hold) > 360)
      throw InputError(fmt::format("--hold: {}: degrees from -360 to 360 are needed", *a.hold));
    return {*a.hold / kDegrees, *a.hold / kDegrees, 1};
  }
  run.input(a.motion);
  return read_motion(a.motion);
}

int run_simulate(const SimulateArguments& a, const CommonOptions& common) {
  Run run("simulate", common);
  if (a.motion.empty() == !a.hold) throw InputError("simulate: one of --motion FILE and --hold DEG is needed");
  const Scene scene = read_scene(a.scene);
  run.input(a.scene);
  const Actuator actuator = actuator_of(a.actuator, run);
  const Motion motion = motion_of(a, run);
  const double rate = a.rate.value_or(1000);
  if (!(rate > 0 && rate <= 1e6)) throw InputError(fmt::format("--rate: {}: above 0 to 1e6 Hz is needed", rate));
  SimulateOptions options;
  options.accuracy = a.accuracy.value_or(options.accuracy);
  options.validate();
  return report(checked_landing(scene, actuator, motion, options, rate), run);
}

}  // namespace

void add_simulate(CLI::App& app, Action& chosen) {
  auto args = std::make_shared<SimulateArguments>();
  CLI::App* verb = app.add_subcommand("simulate", "one landing: released, in flight, through its contacts, to rest");
  verb->add_option("SCENE", args->scene, "scene file (TOML)")->required();
  verb->add_option("--actuator", args->actuator, "actuator file (TOML)")->required();
  verb->add_option("--motion", args->motion, "motion file (TOML)");
  verb->add_option("--hold", args->hold, "hold the reference at this angle [deg]; the joint stays compliant");
  verb->add_option("--rate", args->rate, "rows of trajectory.csv a second [1000 Hz]");
  verb->add_option("--accuracy", args->accuracy, "relative tolerance of each step [1e-9]");
  add_action<SimulateArguments>(*verb, args, "ukemi simulate scene.toml --actuator actuator.toml --hold -45 -o out",
                                chosen, run_simulate);
}

}  // namespace ukemi::tools

// ukemi compare: identified against nominal parameters.
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "common/error.hpp"
#include "landing/body/robot_file.hpp"
#include "landing/model/scene_file.hpp"
#include "tools/program/actuators.hpp"
#include "tools/program/verb.hpp"
#include "tools/report/body.hpp"
#include "tools/report/results.hpp"
#include "tools/verbs/body.hpp"
#include "tools/verbs/runs.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

/// Warns where two drives differ in their feedback.
void warn_of_feedback(Feedback nominal, Feedback identified, const std::string& joint, Run& run) {
  if (nominal != identified)
    run.warn(fmt::format("{}the sets differ in what the drive feeds back too: nominal {}, identified {}", joint,
                         name(nominal), name(identified)));
}

/// Sets what the searches for both kinds of robot share.
template <class Options>
void set_search(const CompareArguments& a, const CommonOptions& common, Run& run, Options& o) {
  o.search.evaluations = a.evaluations;
  o.search.seed = common.seed, o.search.threads = common.threads;
  o.search.validate();
  o.monitor = [&run](const std::string& set) { return run.monitor("optimize, " + set, "motions"); };
}

/// The scene with the drives of each set; other drives are the robot's in both.
PerSet<BodyScene> scenes_of(const CompareArguments& a, Run& run) {
  BodyScene nominal = read_body_scene(a.scene, drives_of(a.nominal, "--nominal"));
  PerSet<BodyScene> out = {std::move(nominal), body_of(a.scene, a.identified, run, "--identified")};
  const std::vector<std::string>& known = out[1].drive_files;
  for (const std::string& file : out[0].drive_files)
    if (std::find(known.begin(), known.end(), file) == known.end()) (void)actuator_of(file, run);
  return out;
}

BodyComparisonOptions options_of(const CompareArguments& a, const PerSet<BodyScene>& scenes,
                                 const CommonOptions& common, Run& run) {
  const BodyScene& scene = scenes[1];
  BodyComparisonOptions out;
  if (a.robust) {
    out.search.measure = Measure::parse("--robust", *a.robust);
    out.search.scatter = scatter_of(a.scatter), out.search.inflate = inflate_of(a.scatter, scene, run);
    (void)BodyDropModel(scene, scatter_for(out.search.scatter, scene));  // refuses numbers that this base does not have
    for (std::size_t set : {0, 1}) out.measured[set] = measured_drops(a.scatter, scenes[set], run);
  }
  set_search(a, common, run, out);
  return out;
}

int compare_body(const CompareArguments& a, const CommonOptions& common) {
  Run run(kCompareOutputs, common);
  if (!a.trials.empty() || !a.rig.empty())
    throw InputError(
        "--trials, --rig: they are of one actuator: leave --scene out; with a robot of links compare plans and plays "
        "its "
        "landings");
  const PerSet<BodyScene> scenes = scenes_of(a, run);
  for (std::size_t i = 0; i < scenes[0].robot.joints.size(); ++i) {
    const Joint &nominal = scenes[0].robot.joints[i], &identified = scenes[1].robot.joints[i];
    warn_of_feedback(nominal.sea.feedback, identified.sea.feedback, nominal.name + ": ", run);
  }
  const BodyComparisonOptions options = options_of(a, scenes, common, run);
  const PerSet<std::string> names = {fmt::format("{}", fmt::join(a.nominal, ", ")),
                                     fmt::format("{}", fmt::join(a.identified, ", "))};
  return report(compare(scenes, options), names, run);
}

}  // namespace

int run_compare(const CompareArguments& a, const CommonOptions& common, Comparison* result) {
  if (!a.scene.empty() && is_of_links(a.scene)) return compare_body(a, common);
  const PerSet<std::string> files = {only_actuator(a.nominal, "--nominal"),
                                     only_actuator(a.identified, "--identified")};
  for (const auto& [option, given] : {std::pair("--nominal", &a.nominal), {"--identified", &a.identified}})
    for (const GivenDrive& drive : drives_of(*given, option))
      if (a.scene.empty() && !drive.joint.empty())
        throw InputError(fmt::format("{}: {}={}: JOINT=FILE is of a robot of links, whose --scene is needed", option,
                                     drive.joint, drive.file));
  Run run(kCompareOutputs, common);
  const PerSet<Actuator> sets = {landing_actuator_of(files[0], run), landing_actuator_of(files[1], run)};
  std::optional<RigTrials> measured;
  std::optional<Scene> scene;
  warn_of_feedback(sets[0].sea.feedback, sets[1].sea.feedback, "", run);
  if (!a.scene.empty()) warn_of_unknown_ratings(sets[1], files[1], run);
  if (a.trials.empty() != a.rig.empty()) throw InputError("compare: --trials and --rig belong together");
  if (!a.scene.empty()) scene = scene_of(a.scene, run);
  Json summary;
  if (!a.trials.empty()) {
    const identify::Rig rig = rig_of(a.rig, a.reading);
    run.input(a.rig);
    TrialInputs inputs = read_trials(a.trials, a.reading, rig, {}, run);
    measured = {rig, with_force_curve(inputs.trials, a.reading, rig, rig.mounted(sets[1].sea))};
    summary = std::move(inputs.summary);
  }
  ComparisonOptions o;
  o.escape = escape_of(a.reading);
  if (a.robust && scene) {
    const Scattering scattering = scattering_of(a.scatter, *scene, sets[1], run);
    o.robust.scatter = scattering.scatter, o.robust.inflate = scattering.inflate, o.robust.drops = scattering.measured;
  }
  if (a.robust) o.robust.measure = Measure::parse("--robust", *a.robust);
  if (a.robust && a.scene.empty()) throw InputError("compare: --robust needs --scene");
  set_search(a, common, run, o);
  const Comparison found = compare(sets, measured, scene, o);
  if (result) *result = found;
  return report(found, std::move(summary), run);
}

namespace {

void add_compare(CLI::App* verb, Action& chosen) {
  auto args = std::make_shared<CompareArguments>();
  verb->add_option("--nominal", args->nominal,
                   "actuator file (TOML); of a robot of links JOINT=FILE, once for each joint that differs")
      ->allow_extra_args(false)
      ->required();
  verb->add_option("--identified", args->identified,
                   "actuator file (TOML), with its covariance where there is one; of a robot of links JOINT=FILE")
      ->allow_extra_args(false)
      ->required();
  verb->add_option("--scene", args->scene, "scene file: best motions, each under both actuators");
  verb->add_option("--evaluations", args->evaluations,
                   "motions of each search, of the plans of --robust landings [as optimize]");
  verb->add_option("--trials", args->trials, "trial files: residuals of both sets");
  verb->add_option("--rig", args->rig, "rig file, with --trials");
  add_trial_options(*verb, args->reading);
  verb->add_option(
      "--robust", args->robust,
      "with a scene, plans for drops that scatter too, with nominal constants, identified, identified with "
      "their covariance: mean, cvar, quantile:Q or worst");
  add_scatter(*verb, args->scatter), add_drops(*verb, args->scatter);
  add_action<CompareArguments>(
      *verb, args, "ukemi compare --nominal nominal.toml --identified actuator.toml --scene scene.toml -o out", chosen,
      [](auto& a, auto& common) { return run_compare(a, common); });
}

const Verb compare_verb(VerbGroup::kConstants, "compare",
                        "identified against nominal parameters: constants, residuals, best motions", add_compare);

}  // namespace

}  // namespace ukemi::tools

// ukemi compare: identified against nominal parameters.
#include <fmt/format.h>

#include <memory>

#include "common/error.hpp"
#include "landing/body/robot_file.hpp"
#include "landing/model/scene_file.hpp"
#include "tools/program/actuators.hpp"
#include "tools/program/verb.hpp"
#include "tools/report/results.hpp"
#include "tools/verbs/body.hpp"
#include "tools/verbs/runs.hpp"

namespace ukemi::tools {

void warn_of_feedback(Feedback nominal, Feedback identified, const std::string& joint, Run& run) {
  if (nominal != identified)
    run.warn(fmt::format("{}the sets differ in what the drive feeds back too: nominal {}, identified {}", joint,
                         name(nominal), name(identified)));
}

int run_compare(const CompareArguments& a, const CommonOptions& common, Comparison* result) {
  if (!a.scene.empty() && landing::is_of_links(a.scene)) return compare_body(a, common);
  const PerSet<std::string> files = {only_actuator(a.nominal, "--nominal"),
                                     only_actuator(a.identified, "--identified")};
  for (const auto& [option, given] : {std::pair("--nominal", &a.nominal), {"--identified", &a.identified}})
    for (const landing::GivenDrive& drive : drives_of(*given, option))
      if (a.scene.empty() && !drive.joint.empty())
        throw InputError(fmt::format("{}: {}={}: JOINT=FILE is of a robot of links, whose --scene is needed", option,
                                     drive.joint, drive.file));
  Run run(kCompareOutputs, common);
  const PerSet<Actuator> sets = {landing_actuator_of(files[0], run), landing_actuator_of(files[1], run)};
  std::optional<RigTrials> measured;
  std::optional<landing::Scene> scene;
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
  if (a.robust) o.robust.measure = landing::Measure::parse("--robust", *a.robust);
  if (a.robust && a.scene.empty()) throw InputError("compare: --robust needs --scene");
  o.search.evaluations = a.evaluations;
  o.search.validate();
  o.search.seed = common.seed, o.search.threads = common.threads;
  o.monitor = [&run](const std::string& set) { return run.monitor("optimize, " + set, "motions"); };
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

// ukemi compare of a robot of links.
#include <fmt/format.h>

#include <algorithm>

#include "common/error.hpp"
#include "tools/program/actuators.hpp"
#include "tools/report/body.hpp"
#include "tools/report/results.hpp"
#include "tools/verbs/body.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

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
  out.search.evaluations = a.evaluations;
  out.search.seed = common.seed, out.search.threads = common.threads;
  if (a.robust) {
    out.search.measure = Measure::parse("--robust", *a.robust);
    out.search.scatter = scatter_of(a.scatter), out.search.inflate = inflate_of(a.scatter, scene, run);
    (void)BodyDropModel(scene, scatter_for(out.search.scatter, scene));  // refuses numbers that this base does not have
    for (std::size_t set : {0, 1}) out.measured[set] = measured_drops(a.scatter, scenes[set], run);
  }
  out.search.validate();
  out.monitor = [&run](const std::string& set) { return run.monitor("optimize, " + set, "motions"); };
  return out;
}

}  // namespace

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

}  // namespace ukemi::tools

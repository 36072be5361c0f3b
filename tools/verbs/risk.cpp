// ukemi risk.
#include <fmt/format.h>

#include <memory>

#include "common/error.hpp"
#include "landing/body/robot_file.hpp"
#include "landing/judge/risk.hpp"
#include "landing/judge/under_scatter.hpp"
#include "landing/model/scene_file.hpp"
#include "landing/plan/body_goal.hpp"
#include "landing/plan/body_risk.hpp"
#include "tools/program/actuators.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/verb.hpp"
#include "tools/report/body.hpp"
#include "tools/report/results.hpp"
#include "tools/report/risk.hpp"
#include "tools/verbs/body.hpp"
#include "tools/verbs/freedom.hpp"
#include "tools/verbs/given_motion.hpp"
#include "tools/verbs/scattering.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

struct RiskArguments : SceneArguments {
  MotionArguments motion;
  ScatterArguments scatter;
  std::optional<long> samples;
  bool inexact = false;
  std::vector<std::string> forbid;
};

long samples_of(const RiskArguments& a) {
  if (a.samples && (*a.samples < 100 || *a.samples > 10'000'000))
    throw InputError(fmt::format("--samples: {}: 100 to 10000000 are needed", *a.samples));
  return a.samples.value_or(RiskOptions().samples);
}

RiskOptions options_of(const RiskArguments& a, const CommonOptions& common, const Run& run) {
  RiskOptions out;
  out.samples = samples_of(a);
  for (const std::string& point : a.forbid)
    out.forbidden[choice_index("--forbid", point, {kPointNames.begin(), kPointNames.end()})] = true;
  out.seed = common.seed, out.threads = common.threads;
  out.monitor = run.monitor("risk", "landings");
  return out;
}

int risk_body(const RiskArguments& a, const CommonOptions& common) {
  Run run(kRiskOutputs, common);
  BodyScene scene = body_of(a, run);
  forbid(scene, a.forbid, "--forbid");
  const BodyMotion motion = motion_of(scene, a.motion, run);
  BodyRiskOptions options;
  options.samples = samples_of(a);
  options.measured = measured_drops(a.scatter, scene, run);
  options.scatter = scatter_of(a.scatter);
  options.drops = {.inflate = inflate_of(a.scatter, scene, run), .inexact = a.inexact};
  options.seed = common.seed, options.threads = common.threads;
  options.monitor = run.monitor("risk", "landings");
  return report(scene, motion, body_risk(scene, motion, options), options, run);
}

int run_risk(const RiskArguments& a, const CommonOptions& common) {
  a.scatter.refuse_beside_drops(a.inexact, "--inexact");
  a.scatter.refuse_beside_drops(a.samples.has_value(), "--samples");
  if (is_of_links(a.scene)) return risk_body(a, common);
  refuse_set(a.set);
  Run run(kRiskOutputs, common);
  const Scene scene = scene_of(a.scene, run);
  const Actuator actuator = rated_actuator_of(only_actuator(a.actuators), run);
  const Motion motion = motion_of(a.motion, "risk", run);
  RiskOptions options = options_of(a, common, run);
  RiskStudy study{.scene = scene, .actuator = actuator, .motion = motion};
  const Scattering scattering = scattering_of(a.scatter, scene, actuator, run);
  study.scattering = {.inflate = scattering.inflate, .inexact = a.inexact};
  options.measured = scattering.measured;
  if (options.measured.empty()) {
    study.scatter = scatter_for(scattering.scatter, scene);
    study.assumed = !scattering.scatter && !scene.scatter;
  }
  const DropModel model(scene, study.scatter.value_or(Scatter{}), actuator, study.scattering);
  study.risk = risk(model, actuator, motion, options);
  return report(study, run);
}

void add_risk(CLI::App* verb, Action& chosen) {
  auto args = std::make_shared<RiskArguments>();
  add_scene(*verb, *args);
  add_motion(*verb, args->motion);
  add_scatter(*verb, args->scatter), add_drops(*verb, args->scatter);
  verb->add_flag("--inexact", args->inexact, "the motion is played anywhere within the scene's [execution] tolerance");
  verb->add_option("--forbid", args->forbid, "points whose touches are counted: hip,knee,foot")->delimiter(',');
  verb->add_option("--samples", args->samples, "drops that are drawn, 100 to 10000000 [10000]");
  add_action<RiskArguments>(*verb, args,
                            "ukemi risk scene.toml --actuator actuator.toml --motion motion.toml "
                            "--scatter pitch_deg=1,height=0.01 -o out",
                            chosen, run_risk);
}

const Verb risk_verb(VerbGroup::kLandings, "risk",
                     "the peaks of a motion over drops that scatter, and what scatters them", add_risk);

}  // namespace

}  // namespace ukemi::tools

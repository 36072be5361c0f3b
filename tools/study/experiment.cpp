#include "tools/study/experiment.hpp"

#include <fmt/format.h>

#include "common/error.hpp"
#include "identify/fit/fit.hpp"
#include "identify/logs/trial_checks.hpp"

namespace ukemi::tools {

namespace {

identify::DesignOptions options_of(const DesignRequest& r) {
  identify::DesignOptions o = r.options;
  if (r.trials.empty() && !r.noise)
    throw InputError(r.noise_name + ": without trials the noise of the angle [rad] is needed");
  o.log.noise = r.noise ? *r.noise : identify::noise_level(r.trials);
  if (!(o.log.noise > 0) && !r.noise)
    throw InputError(r.noise_name + ": the trials show none: the noise of the angle [rad] is needed");
  for (const identify::Trial& t : r.trials)
    if (!t.phi_motor.empty()) o.log.outputs = identify::HitLog::Outputs::kLinkAndMotor;
  o.validate();
  return o;
}

/// The information on the constants before the hits.
identify::Knowledge knowledge_of(const DesignRequest& r, double noise) {
  Actuator actuator = r.actuator;
  actuator.sea = r.rig.mounted(actuator.sea);
  actuator.sea.tau_max = r.tau_max.value_or(actuator.sea.tau_max);
  const std::vector<int> uncertain = identify::uncertain_constants(actuator);
  if (uncertain.empty())
    throw InputError(Location{r.actuator_name}, "no uncertain constant above 0: there is nothing to shrink");
  const std::optional<identify::Knowledge> knowledge =
      r.trials.empty() ? identify::knowledge_of(actuator)
                       : identify::knowledge_of(r.rig, actuator.sea, uncertain, r.trials, noise);
  if (!knowledge)
    throw InputError(Location{r.actuator_name},
                     "no covariance of the constants, or a singular one: give the trials in hand");
  return *knowledge;
}

}  // namespace

DesignQuestion design_question(const DesignRequest& r) {
  if (r.rig.drive.known_command())
    throw InputError(Location{r.rig_name},
                     "the drive follows a command that is logged: of a hit to come none is known; a controller in the "
                     "loop is needed ([drive] command_gain, angle = \"predicted\")");
  DesignQuestion out{.rig = r.rig, .knowledge = {}, .trials = r.trials, .options = options_of(r)};
  out.knowledge = knowledge_of(r, out.options.log.noise);
  return out;
}

std::vector<std::string> design_doubts(const DesignQuestion& q) {
  std::vector<std::string> out;
  const SeaParameters<double>& sea = q.knowledge.sea;
  if (sea.friction != 0 || sea.k_sea_cubic != 0)
    out.push_back("friction and stiffening are taken as known: only the five constants are designed for");
  if (q.trials.empty()) return out;
  const double rms = identify::predict(q.rig, q.trials, sea).rms, noise = q.options.log.noise;
  if (rms > identify::kFarAboveNoise * noise)
    out.push_back(fmt::format("the actuator misses these trials by {:.3g} rad, {:.1f} times the noise: fit them first",
                              rms, rms / noise));
  return out;
}

DesignAnswer answer(const DesignQuestion& q, int checks) {
  DesignAnswer out{identify::design(q.rig, q.knowledge, q.options), {}};
  if (out.design.status != identify::Design::Status::kDone || checks <= 0) return out;
  std::vector<identify::Hit> hits;
  for (const identify::ProposedHit& h : out.design.hits) hits.push_back(h.hit);
  out.check = identify::check(q.rig, q.knowledge, q.trials, hits, q.options, checks);
  return out;
}

}  // namespace ukemi::tools

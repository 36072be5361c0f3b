// ukemi design: which hit to try next.
#include "identify/design/design.hpp"

#include <fmt/format.h>

#include <memory>

#include "common/error.hpp"
#include "tools/program/actuators.hpp"
#include "tools/program/trials.hpp"
#include "tools/report/design.hpp"
#include "tools/verbs/verbs.hpp"

namespace ukemi::tools {

namespace {

struct DesignArguments {
  std::vector<std::string> trials;
  std::string rig, actuator;
  identify::Criterion criterion = identify::Criterion::kWorst;
  TrialArguments reading;
  identify::HitBudget budget;
  std::vector<double> width = {0.010, 0.020};
  identify::HitLog log;
  std::optional<double> noise, tau_max;
  int hits = 2, check = 50;
};

identify::DesignOptions options_of(const DesignArguments& a, const std::vector<identify::Trial>& trials,
                                   const CommonOptions& common) {
  identify::DesignOptions o{.budget = a.budget, .log = a.log, .hits = a.hits, .criterion = a.criterion};
  o.budget.min_width = a.width.front(), o.budget.max_width = a.width.back();
  o.seed = common.seed, o.threads = common.threads;
  if (trials.empty() && !a.noise) throw InputError("--noise: without trials the noise of the angle [rad] is needed");
  o.log.noise = a.noise ? *a.noise : identify::noise_level(trials);
  if (!(o.log.noise > 0) && !a.noise)
    throw InputError("--noise: the trials show none: the noise of the angle [rad] is needed");
  for (const identify::Trial& t : trials)
    if (!t.phi_motor.empty()) o.log.outputs = identify::HitLog::Outputs::kLinkAndMotor;
  o.validate();
  return o;
}

/// What is known of the constants before the hits.
identify::Knowledge knowledge_of(const DesignArguments& a, const identify::Rig& rig, Actuator actuator,
                                 const std::vector<identify::Trial>& trials, double noise) {
  actuator.sea = rig.mounted(actuator.sea);
  actuator.sea.tau_max = a.tau_max.value_or(actuator.sea.tau_max);
  const std::vector<int> uncertain = identify::uncertain_constants(actuator);
  if (uncertain.empty()) throw InputError({a.actuator}, "no uncertain constant above 0: there is nothing to shrink");
  const std::optional<identify::Knowledge> knowledge =
      trials.empty() ? identify::knowledge_of(actuator)
                     : identify::knowledge_of(rig, actuator.sea, uncertain, trials, noise);
  if (!knowledge)
    throw InputError({a.actuator}, "no covariance of the constants, or a singular one: give the trials in hand");
  return *knowledge;
}

/// Warns where the knowledge may not hold.
void warn_of(const DesignQuestion& question, const std::vector<identify::Trial>& trials, Run& run) {
  const SeaParameters<double>& sea = question.knowledge.sea;
  if (sea.friction != 0 || sea.k_sea_cubic != 0)
    run.warn("friction and stiffening are taken as known: only the five constants are designed for");
  if (trials.empty()) return;
  const double rms = identify::predict(question.rig, trials, sea).rms, noise = question.options.log.noise;
  if (rms > identify::kFarAboveNoise * noise)
    run.warn(fmt::format("the actuator misses these trials by {:.3g} rad, {:.1f} times the noise: fit them first", rms,
                         rms / noise));
}

int run_design(const DesignArguments& a, const CommonOptions& common) {
  Run run("design", common);
  DesignQuestion question{.rig = rig_of(a.rig, a.reading)};
  run.input(a.rig);
  if (question.rig.drive.by_command())
    throw InputError({a.rig},
                     "the drive follows a command that is logged: of a hit to come none is known; "
                     "a controller in the loop is needed ([drive] command_gain, angle = \"predicted\")");
  const Actuator actuator = actuator_of(a.actuator, run);
  TrialInputs inputs;
  if (!a.trials.empty())
    inputs = read_trials(a.trials, a.reading, question.rig, {.excitation = TrialNeeds::Excitation::kRequired}, run);
  inputs.trials = with_force_curve(inputs.trials, a.reading, question.rig, question.rig.mounted(actuator.sea));
  const std::vector<identify::Trial>& trials = inputs.trials;
  const identify::DesignOptions& o = question.options = options_of(a, trials, common);
  question.trials = trials;
  question.knowledge = knowledge_of(a, question.rig, actuator, trials, o.log.noise);
  warn_of(question, trials, run);

  run.info(fmt::format("looking for {} hits", o.hits));
  DesignAnswer answer{identify::design(question.rig, question.knowledge, o), {}};
  if (answer.design.status == identify::Design::Status::kDone && a.check > 0) {
    run.info(fmt::format("checking by {} simulated experiments", a.check));
    std::vector<identify::Hit> hits;
    for (const identify::ProposedHit& h : answer.design.hits) hits.push_back(h.hit);
    answer.check = identify::check(question.rig, question.knowledge, trials, hits, o, a.check);
  }
  return report(question, answer, std::move(inputs.summary), run);
}

}  // namespace

void add_design(CLI::App& app, Action& chosen) {
  auto args = std::make_shared<DesignArguments>();
  CLI::App* verb = app.add_subcommand("design", "propose the hits that shrink the constants' error bars most");
  verb->add_option("TRIAL", args->trials, "trials in hand [none: what is known is the actuator's covariance]");
  verb->add_option("--rig", args->rig, "rig file (TOML)")->required();
  verb->add_option("--actuator", args->actuator, "actuator file (TOML): the present estimate")->required();
  verb->add_option("--peak", args->budget.peak, "largest force of a hit [N] [300]");
  verb->add_option("--width", args->width, "shortest and longest pulse [s] [0.010 0.020]")->expected(1, 2);
  verb->add_option("--angle", args->budget.angle,
                   "largest |phi_1| [rad], kept wherever the constants may lie within their uncertainty [0.6]");
  verb->add_option("--hits", args->hits, "how many hits, each a trial of its own [2]");
  using enum identify::Criterion;
  add_choice(*verb, "--criterion", args->criterion, {{"worst", kWorst}, {"d", kD}, {"e", kE}},
             "what becomes smallest: worst (the worst-known constant's interval), d (the volume of the "
             "ellipsoid), e (its longest axis) [worst]");
  using enum identify::HitBudget::Directions;
  add_choice(*verb, "--directions", args->budget.directions, {{"both", kAlternate}, {"positive", kPositive}},
             "both (hits alternate) or positive [both]");
  verb->add_option("--rate", args->log.rate, "of the next logs [Hz] [1000]");
  verb->add_option("--duration", args->log.duration, "of the next logs [s] [1]");
  verb->add_option("--noise", args->noise, "standard deviation of an angle [rad] [the trials' own]");
  verb->add_option("--tau-max", args->tau_max, "torque limit of the spring [Nm] [the rig's, else the actuator's]")
      ->check(CLI::NonNegativeNumber);
  verb->add_option("--check", args->check, "simulated experiments that test the prediction, 0: none [50]")
      ->check(CLI::Range(0, 100000));
  add_trial_options(*verb, args->reading);
  add_action<DesignArguments>(
      *verb, args,
      "ukemi design trial_1.csv trial_2.csv --rig rig.toml --actuator out/identify/actuator.toml --peak 300 "
      "--width 0.010 0.020 --angle 0.6 -o out/design",
      chosen, run_design);
}

}  // namespace ukemi::tools

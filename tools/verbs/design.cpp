// ukemi design: which hit to try next.
#include <fmt/format.h>

#include <memory>

#include "common/error.hpp"
#include "tools/program/actuators.hpp"
#include "tools/program/trials.hpp"
#include "tools/program/verb.hpp"
#include "tools/report/design.hpp"

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

DesignRequest request_of(const DesignArguments& a, const CommonOptions& common, Run& run) {
  DesignRequest out{.rig = rig_of(a.rig, a.reading),
                    .actuator = {},
                    .options = {.budget = a.budget, .log = a.log, .hits = a.hits, .criterion = a.criterion},
                    .noise = a.noise,
                    .tau_max = a.tau_max,
                    .rig_name = a.rig,
                    .actuator_name = a.actuator,
                    .noise_name = "--noise"};
  run.input(a.rig);
  out.options.budget.min_width = a.width.front(), out.options.budget.max_width = a.width.back();
  out.options.seed = common.seed, out.options.threads = common.threads;
  return out;
}

int run_design(const DesignArguments& a, const CommonOptions& common) {
  Run run(kDesignOutputs, common);
  DesignRequest request = request_of(a, common, run);
  request.actuator = actuator_of(a.actuator, run);
  TrialInputs inputs;
  if (!a.trials.empty())
    inputs = read_trials(a.trials, a.reading, request.rig, {.excitation = TrialNeeds::Excitation::kRequired}, run);
  request.trials = with_force_curve(inputs.trials, a.reading, request.rig, request.rig.mounted(request.actuator.sea));
  const DesignQuestion question = design_question(request);
  for (const std::string& doubt : design_doubts(question)) run.warn(doubt);
  run.info(fmt::format("looking for {} hits, and checking them by {} simulated experiments", a.hits, a.check));
  return report(question, answer(question, a.check), std::move(inputs.summary), run);
}

void add_design(CLI::App* verb, Action& chosen) {
  auto args = std::make_shared<DesignArguments>();
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

const Verb design_verb(VerbGroup::kConstants, "design", "propose the hits that shrink the constants' error bars most",
                       add_design);

}  // namespace

}  // namespace ukemi::tools

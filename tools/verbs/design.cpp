// ukemi design: which hit to try next.
#include <fmt/format.h>

#include <memory>

#include "common/error.hpp"
#include "tools/program/actuators.hpp"
#include "tools/program/arguments.hpp"
#include "tools/program/command.hpp"
#include "tools/program/trials.hpp"
#include "tools/program/verb.hpp"
#include "tools/report/design.hpp"
#include "tools/verbs/calibrate.hpp"
#include "tools/verbs/robot_logs.hpp"

namespace ukemi::tools {

namespace {

struct DesignArguments {
  std::vector<std::string> trials, next;  ///< existing trials; of a robot, logs of commands to choose from
  std::string rig, actuator, robot, pieces, free, heights;
  identify::Criterion criterion = identify::Criterion::kWorst;
  TrialArguments reading;
  identify::HitBudget budget;
  std::vector<double> width = {0.010, 0.020};
  identify::HitLog log;
  std::string noise;  ///< [rad]; of a robot CHANNEL=STD,...
  std::optional<double> tau_max;
  int hits = 2, check = 50, tie = 1;
  std::vector<std::string> given;  ///< names of the options on the command line
};

/// Of a robot of links: chooses which of `next` to log.
int design_robot(const DesignArguments& a, const CommonOptions& common) {
  Run run(kDesignOutputs, common);
  allow_only(a.given,
             {"--robot", "--next", "--free", "--hits", "--criterion", "--noise", "--heights", "--columns", "--pieces",
              "--tie", "--multi-turn"},
             "--robot");
  if (a.next.empty()) throw InputError("--next: with --robot logs of commands to choose from are needed");
  if (a.free.empty()) throw InputError("--free: with --robot the constants that are to be known must be named");
  const DrivenRobot robot = robot_of(a.robot, run);
  RobotLogOptions reading = reading_of(a.reading);
  const std::vector<RobotTrial> in_hand =
      read_trials({a.trials, a.reading.columns, a.pieces, a.tie}, reading, robot, run);
  reading.measured = RobotLogOptions::Measured::kNothing;
  std::vector<double> heights;
  for (const std::string& height : split(a.heights)) heights.push_back(to_number("--heights", height));
  const std::vector<RobotTrial> next =
      from_heights(robot, read_trials({.files = a.next, .columns = {}, .pieces = {}}, reading, robot, run), heights);

  RobotDesignOptions options{.criterion = a.criterion, .trials = a.hits};
  for (const std::string& item : split(a.noise)) {
    const Assignment one = assignment("--noise", item, "CHANNEL=STD");
    set_once("--noise", one.name, one.name, to_number("--noise", one.value), options.noise);
  }
  options.fit.terms = design_terms(robot, in_hand, next, options.noise);
  CalibrateArguments fit;
  fit.free = a.free, fit.nuisance = fmt::format("{}", fmt::join(options.fit.terms.nuisance, ","));
  set_options(fit, common, options.fit);
  options.fit.threads = common.threads;
  return report(design_trials(robot, in_hand, next, options), run);
}

DesignRequest request_of(const DesignArguments& a, const CommonOptions& common, Run& run) {
  DesignRequest out{.rig = rig_of(a.rig, a.reading),
                    .actuator = {},
                    .options = {.budget = a.budget, .log = a.log, .hits = a.hits, .criterion = a.criterion},
                    .noise = a.noise.empty() ? std::nullopt : std::optional(to_number("--noise", a.noise)),
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
  if (!a.robot.empty()) return design_robot(a, common);
  if (a.rig.empty()) throw InputError("--rig is required, or --robot of a robot of links");
  if (a.actuator.empty()) throw InputError("--actuator is required");
  for (const auto& [given, option] :
       {std::pair(!a.next.empty(), "--next"), {!a.free.empty(), "--free"}, {!a.heights.empty(), "--heights"}})
    if (given) throw InputError(std::string(option) + ": --robot is needed with it");
  check_no_pieces(a.pieces, a.tie);
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
  verb->add_option("--rig", args->rig, "rig file (TOML)");
  verb->add_option("--actuator", args->actuator, "actuator file (TOML): the present estimate");
  verb->add_option("--robot", args->robot,
                   "of a robot of links, in place of both: robot file (TOML), as it was fitted");
  verb->add_option("--next", args->next,
                   "with --robot: logs of commands that could be played next (CSV, angles not needed)");
  verb->add_option("--heights", args->heights,
                   "with --robot: each of --next from each of these heights of its lowest contact over the floor, "
                   "LIST [m] [on the floor]");
  verb->add_option("--free", args->free, "with --robot: the constants that are to be known");
  add_pieces(*verb, args->pieces, args->tie);
  verb->add_option("--peak", args->budget.peak, "largest force of a hit [N] [300]");
  verb->add_option("--width", args->width, "shortest and longest pulse [s] [0.010 0.020]")->expected(1, 2);
  verb->add_option("--angle", args->budget.angle,
                   "largest |phi_1| [rad], kept wherever the constants may lie within their uncertainty [0.6]");
  verb->add_option("--hits", args->hits, "how many hits, each a trial of its own; of a robot, how many of --next [2]");
  add_choice(*verb, "--criterion", args->criterion, criteria(),
             "what becomes smallest: worst (the worst-known constant's interval), d (the volume of the "
             "ellipsoid), e (its longest axis) [worst]");
  using enum identify::HitBudget::Directions;
  add_choice(*verb, "--directions", args->budget.directions, {{"both", kAlternate}, {"positive", kPositive}},
             "both (hits alternate) or positive [both]");
  verb->add_option("--rate", args->log.rate, "of the next logs [Hz] [1000]");
  verb->add_option("--duration", args->log.duration, "of the next logs [s] [1]");
  verb->add_option("--noise", args->noise,
                   "standard deviation of an angle [rad]; of a robot CHANNEL=STD,... (phi=0.001,torque=0.1) [the "
                   "trials' own]");
  verb->add_option("--tau-max", args->tau_max, "torque limit of the spring [Nm] [the rig's, else the actuator's]")
      ->check(CLI::NonNegativeNumber);
  verb->add_option("--check", args->check, "simulated experiments that test the prediction, 0: none [50]")
      ->check(CLI::Range(0, 100000));
  add_trial_options(*verb, args->reading);
  note_given(*verb, {args, &args->given});
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

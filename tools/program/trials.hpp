// Trials for the verbs: CSV, HEBI logs, and force logs of their own.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "identify/fit/fit.hpp"
#include "identify/logs/force_log.hpp"
#include "identify/logs/hebi_trial.hpp"
#include "tools/program/output.hpp"

namespace ukemi::tools {

/// How the trial files are to be read.
struct TrialArguments {
  std::string columns;  ///< of CSV trials
  std::string module;   ///< of HEBI logs
  identify::TrialOptions::Angles angles = identify::TrialOptions::Angles::kOneTurn;
  identify::HebiTrialOptions::Effort effort = identify::HebiTrialOptions::Effort::kIgnored;
  std::vector<std::string> force_logs;  ///< none, one for all trials, or one each
  std::string force_columns;
  identify::ForceClock force_clock = identify::ForceClock::kOwn;
  std::vector<std::string> trial_rigs;                          ///< FILE=RIG: a rig of its own for a trial
  identify::Drive::Kind drive = identify::Drive::Kind::kGains;  ///< kCommand: the logged command drives every trial
  std::optional<double> force_noise;  ///< of the load cell [N]; else estimated before each first hit
  /// The force between its samples; kByResiduals: what the residuals ask for, of the fit or of the constants given.
  enum class ForceCurve { kByResiduals, kLinear, kSmooth } force_curve = ForceCurve::kByResiduals;
};

struct TrialInputs {
  std::vector<identify::Trial> trials;
  Json summary = Json::object();  ///< "force_logs", "force_noise", "modules", each where there is something to say
};

/// --columns, --module, --hebi-effort, --multi-turn, --force-log, --force-columns, --force-clock, --force-noise,
/// --force-curve, --trial-rig, --drive.
void add_trial_options(CLI::App& verb, TrialArguments& arguments);

/// The rig, driven as --drive says. Throws InputError.
identify::Rig rig_of(const std::string& path, const TrialArguments& arguments);

/// Beyond which angle a rollout has escaped [rad]: infinite where many turns are meant.
double escape_of(const TrialArguments& arguments);

/// What a verb cannot do without.
struct TrialNeeds {
  enum class Angle { kRequired, kOptional } phi = Angle::kRequired;
  enum class Excitation { kRequired, kOptional } excitation = Excitation::kOptional;
};

/// Reads the trials the way the rig says, with their forces, which are at rest between hits; warns of what was handled
/// while reading and of trials with the same content. Throws InputError.
TrialInputs read_trials(const std::vector<std::string>& paths, const TrialArguments& arguments,
                        const identify::Rig& rig, const TrialNeeds& needs, Run& run);

/// The trials with the force between their samples as these constants' residuals suggest, unless the option states it.
std::vector<identify::Trial> with_force_curve(const std::vector<identify::Trial>& trials,
                                              const TrialArguments& arguments, const identify::Rig& rig,
                                              const SeaParameters<double>& sea);

/// One trial of any kind, CSV or HEBI log; what a log says of its module is added to `modules`. Throws InputError.
identify::Trial read_any(const std::string& path, const TrialArguments& arguments, const identify::TrialOptions& csv,
                         const identify::Rig& rig, Json& modules);

}  // namespace ukemi::tools

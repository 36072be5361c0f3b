// Reading of trials: CSV, HEBI logs, and separate force logs.
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
  std::vector<std::string> force_logs;  ///< none, one for all trials, or one for each
  std::string force_columns;
  identify::ForceClock force_clock = identify::ForceClock::kOwn;
  std::vector<std::string> trial_rigs;                          ///< FILE=RIG: the rig of a single trial
  identify::Drive::Kind drive = identify::Drive::Kind::kGains;  ///< kCommand: the logged command drives every trial
  std::optional<double> force_noise;  ///< of the load cell [N]; else estimated before each first hit
  /// Interpolation of the force; kByResiduals: as the residuals suggest, of the fit or of the given constants.
  enum class ForceCurve { kByResiduals, kLinear, kSmooth } force_curve = ForceCurve::kByResiduals;
};

struct TrialInputs {
  std::vector<identify::Trial> trials;
  Json summary = Json::object();  ///< "force_logs", "force_noise", "modules", each where there is one
};

/// --columns, --module, --hebi-effort, --multi-turn, --force-log, --force-columns, --force-clock, --force-noise,
/// --force-curve, --trial-rig, --drive.
void add_trial_options(CLI::App& verb, TrialArguments& arguments);

/// The rig of a file with the drive of --drive. Throws InputError.
identify::Rig rig_of(const std::string& path, const TrialArguments& arguments);

/// Angle beyond which a rollout counts as escaped [rad]; infinite with --multi-turn.
double escape_of(const TrialArguments& arguments);

/// The content of a trial that a verb requires.
struct TrialNeeds {
  enum class Angle { kRequired, kOptional } phi = Angle::kRequired;
  enum class Excitation { kRequired, kOptional } excitation = Excitation::kOptional;
};

/// Reads the trials of the rig with their forces, which are at rest between hits; warns of the readers' notes and of
/// trials with the same content. Throws InputError.
TrialInputs read_trials(const std::vector<std::string>& paths, const TrialArguments& arguments,
                        const identify::Rig& rig, const TrialNeeds& needs, Run& run);

/// The trials with the force interpolated as the residuals under `sea` suggest, unless --force-curve states it.
std::vector<identify::Trial> with_force_curve(const std::vector<identify::Trial>& trials,
                                              const TrialArguments& arguments, const identify::Rig& rig,
                                              const SeaParameters<double>& sea);

/// Reads a trial, CSV or HEBI log; appends what a log states about its module to `modules`. Throws InputError.
identify::Trial read_trial_file(const std::string& path, const TrialArguments& arguments,
                                const identify::TrialOptions& csv, const identify::Rig& rig, Json& modules);

}  // namespace ukemi::tools

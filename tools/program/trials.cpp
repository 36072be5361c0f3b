#include "tools/program/trials.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "common/error.hpp"
#include "identify/logs/drive_command.hpp"
#include "identify/logs/hebi_trial.hpp"
#include "identify/logs/hits.hpp"
#include "identify/logs/trial_checks.hpp"
#include "tools/program/command.hpp"

namespace ukemi::tools {

namespace {

Json gains_json(const std::optional<identify::HebiGains>& g) {
  if (!g) return nullptr;
  return {{"kp", number(g->k_p)}, {"ki", number(g->k_i)}, {"kd", number(g->k_d)}};
}

/// What the log states about the module, for the summary.
Json module_json(const std::string& file, const identify::HebiModule& m) {
  return {{"file", file},
          {"name", m.name},
          {"family", m.family},
          {"address", m.address},
          {"samples", m.t.size()},
          {"spring_constant", number(m.spring_constant)},
          {"position_gains", gains_json(m.position_gains)},
          {"velocity_gains", gains_json(m.velocity_gains)},
          {"effort_gains", gains_json(m.effort_gains)}};
}

/// Assigns the rigs of --trial-rig, by the trial's path or file name. Throws InputError.
void assign_rigs(std::vector<identify::Trial>& trials, const std::vector<std::string>& given, Run& run) {
  for (const std::string& item : given) {
    const Assignment a = assignment("--trial-rig", item, "FILE=RIG");
    bool found = false;
    for (identify::Trial& t : trials)
      if (t.file == a.name || std::filesystem::path(t.file).filename() == a.name) {
        if (t.rig) throw InputError("--trial-rig: " + quoted(a.name) + ": given twice");
        t.rig = identify::read_rig(a.value), found = true;
      }
    if (!found) throw InputError("--trial-rig: " + quoted(a.name) + ": no such trial");
    run.input(a.value);
  }
}

}  // namespace

identify::Trial read_trial_file(const std::string& path, const TrialArguments& a, const identify::TrialOptions& csv,
                                const identify::Rig& rig, Json& modules) {
  const bool binary = identify::is_hebilog(path);
  if (!binary && (!a.columns.empty() || !identify::is_hebi_csv(path))) return identify::read_trial(path, csv);
  const identify::HebiLog log = binary ? identify::read_hebilog(path) : identify::read_hebi_csv(path);
  identify::Trial trial = identify::hebi_trial(
      log, {.module = a.module, .angles = a.angles, .gear_ratio = rig.gear_ratio, .effort = a.effort});
  modules.push_back(module_json(path, identify::choose_module(log, a.module)));
  return trial;
}

void add_trial_options(CLI::App& verb, TrialArguments& a) {
  verb.add_option("--columns", a.columns,
                  "t=Time,phi=-defl_deg,force=0.001*Fy,...: a CSV trial's columns by other names; a minus flips the "
                  "sign, a number scales; suffixes _ms, _deg, _mrad, _N, _kN convert");
  verb.add_option("--module", a.module, "module of the HEBI logs: name, FAMILY/NAME or number [the only one]");
  verb.add_flag_callback(
      "--hebi-effort", [&a] { a.effort = identify::HebiTrialOptions::Effort::kTorque; },
      "a HEBI log's effort is the trial's torque; its scale, torque_gain, is fitted along");
  verb.add_flag_callback(
      "--multi-turn", [&a] { a.angles = identify::TrialOptions::Angles::kMultiTurn; }, "accepts angles beyond 2 pi");
  verb.add_option("--force-log", a.force_logs,
                  "CSV with t [s], force [N]: one for all trials, or the option once for each")
      ->allow_extra_args(false);
  verb.add_option("--force-columns", a.force_columns, "t=Time,force=-Fy: the force log's columns by other names");
  using enum identify::ForceClock;
  add_choice(verb, "--force-clock", a.force_clock, {{"own", kOwn}, {"shared", kShared}},
             "own: the force log is shifted so that its onset meets the motion's; shared: it is not [own]");
  verb.add_option(
      "--force-noise", a.force_noise,
      "noise of the load cell [N], standard deviation: between hits the force is then at rest, within them it "
      "counts for the errors [estimated before the first hit]");
  using Curve = TrialArguments::ForceCurve;
  add_choice(verb, "--force-curve", a.force_curve,
             {{"auto", Curve::kByResiduals}, {"linear", Curve::kLinear}, {"smooth", Curve::kSmooth}},
             "the force between its samples: linear, a smooth curve through each pulse, or auto: what the residuals of "
             "the fit, or of the constants given, ask for [auto]");
  verb.add_option("--trial-rig", a.trial_rigs, "FILE=RIG: a rig of its own for a trial; once for each")
      ->allow_extra_args(false);
  using Kind = identify::Drive::Kind;
  add_choice(verb, "--drive", a.drive, {{"gains", Kind::kGains}, {"command", Kind::kCommand}},
             "gains: Eq. 3, or the rig's [drive]; command: the motor's torque is k_t times the logged column command "
             "[gains]");
}

identify::Rig rig_of(const std::string& path, const TrialArguments& a) {
  identify::Rig rig = identify::read_rig(path);
  if (a.drive == identify::Drive::Kind::kCommand) rig.drive.kind = a.drive;
  return rig;
}

double escape_of(const TrialArguments& a) {
  return a.angles == identify::TrialOptions::Angles::kMultiTurn ? std::numeric_limits<double>::infinity()
                                                                : identify::kEscape;
}

std::vector<identify::Trial> with_force_curve(const std::vector<identify::Trial>& trials, const TrialArguments& a,
                                              const identify::Rig& rig, const SeaParameters<double>& sea) {
  if (a.force_curve != TrialArguments::ForceCurve::kByResiduals) return trials;
  return identify::with_nearer_force(rig, trials, sea, {.escape = escape_of(a)});
}

namespace {

/// Attaches the force logs; what was attached, as JSON.
Json attach_forces(std::vector<identify::Trial>& trials, const TrialArguments& a, const identify::Rig& rig, Run& run) {
  Json out = Json::array();
  for (std::size_t m = 0; m < trials.size() && !a.force_logs.empty(); ++m) {
    identify::Trial& trial = trials[m];
    const std::string& path = a.force_logs[a.force_logs.size() > 1 ? m : 0];
    run.input(path);
    const bool own = a.force_clock == identify::ForceClock::kOwn;
    const double shift =
        identify::attach_force(trial, identify::read_force_log(path, a.force_columns), rig, a.force_clock);
    out.push_back({{"trial", trial.file}, {"file", path}, {"clock", own ? "own" : "shared"}, {"shift", number(shift)}});
  }
  return out;
}

/// What is said of trials that were read: last, so that a refused input prints its error alone.
void say_of_trials(const std::vector<identify::Trial>& trials, const Json& forces, double largest_noise,
                   const TrialArguments& a, Run& run) {
  if (largest_noise > 0)
    run.say(
        fmt::format("force noise {:.3g} N{}: between hits the force is at rest, within them its noise weighs the "
                    "residuals",
                    largest_noise, a.force_noise ? "" : " at most, estimated before each first hit"));
  for (const identify::Trial& t : trials)
    if (t.force_rest != 0)
      run.warn(fmt::format("{}: the load cell reads {:.3g} N at rest: tare it, or --nuisance force_bias", t.file,
                           t.force_rest));
  for (const identify::Trial& t : trials)
    for (const std::string& note : t.notes) run.warn(t.file + ": " + note);
  for (const Json& f : forces)
    if (f["clock"] == "own")
      run.say(fmt::format("{}: moved by {:.6g} s onto the clock of {}", f["file"].get<std::string>(),
                          f["shift"].get<double>(), f["trial"].get<std::string>()));
  for (std::size_t i = 0; i < trials.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (identify::same_content(trials[j], trials[i])) {
        run.warn(fmt::format("trials {} ({}) and {} ({}) have the same content: they count twice", j + 1,
                             trials[j].file, i + 1, trials[i].file));
        break;
      }
}

}  // namespace

TrialInputs read_trials(const std::vector<std::string>& paths, const TrialArguments& a, const identify::Rig& rig,
                        const TrialNeeds& needs, Run& run) {
  if (paths.empty()) throw InputError("no trials: at least one trial file is needed");
  if (a.force_logs.empty() && !a.force_columns.empty()) throw InputError("--force-columns: --force-log is needed");
  if (a.force_logs.size() > 1 && a.force_logs.size() != paths.size())
    throw InputError(fmt::format("--force-log: {} files for {} trials: one for all or one for each is needed",
                                 a.force_logs.size(), paths.size()));
  const identify::TrialOptions csv{.columns = a.columns,
                                   .require_phi = needs.phi == TrialNeeds::Angle::kRequired,
                                   .force = a.force_logs.empty() ? identify::TrialOptions::Force::kInFile
                                                                 : identify::TrialOptions::Force::kElsewhere,
                                   .angles = a.angles,
                                   .gear_ratio = rig.gear_ratio.value_or(1)};
  TrialInputs out;
  Json modules = Json::array();
  for (const std::string& path : paths) {
    run.input(path);
    out.trials.push_back(read_trial_file(path, a, csv, rig, modules));
  }
  for (const std::string& warning : duplicate_warnings(paths)) run.warn(warning);
  assign_rigs(out.trials, a.trial_rigs, run);
  if (a.drive == identify::Drive::Kind::kCommand)
    for (identify::Trial& t : out.trials)
      if (t.rig) t.rig->drive.kind = a.drive;
  for (identify::Trial& t : out.trials) t.command = identify::drive_command(t, t.rig_or(rig).drive);
  if (!a.module.empty() && modules.empty())
    throw InputError("--module: " + quoted(a.module) + ": no trial is a HEBI log");
  const Json forces = attach_forces(out.trials, a, rig, run);
  if (a.force_noise && !(*a.force_noise >= 0 && std::isfinite(*a.force_noise)))
    throw InputError(fmt::format("--force-noise: {}: at least 0 N is needed", *a.force_noise));
  Json noises = Json::array();
  double largest_noise = 0;
  for (identify::Trial& t : out.trials) {
    identify::flatten_force_between_hits(t, a.force_noise);
    if (a.force_curve == TrialArguments::ForceCurve::kSmooth) t.force_smooth = 1;
    noises.push_back(number(t.force_noise)), largest_noise = std::max(largest_noise, t.force_noise);
  }
  if (largest_noise > 0) out.summary["force_noise"] = noises;
  if (needs.excitation == TrialNeeds::Excitation::kRequired)
    for (const identify::Trial& t : out.trials) identify::require_excitation(t);
  if (!modules.empty()) out.summary["modules"] = modules;
  if (!forces.empty()) out.summary["force_logs"] = forces;

  say_of_trials(out.trials, forces, largest_noise, a, run);
  return out;
}

}  // namespace ukemi::tools

#include "tools/report/identify.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "common/eigen.hpp"
#include "tools/program/actuators.hpp"
#include "tools/report/estimates.hpp"
#include "tools/report/residuals.hpp"

namespace ukemi::tools {

const Outputs kIdentifyOutputs = Outputs{
    "identify",
    {"actuator.toml", "robot.toml", "fit.csv", "profile.csv", "actuator.mjcf.xml", "actuator.urdf.xml"},
    {"ladder", "weakest",
     "profile_#"}}.with(fit_figures());

using identify::Fit;
using identify::Trial;

namespace {

Quantities<identify::Minimum> minimum_quantities() {
  Quantities<identify::Minimum> out = {
      {"", "cost", "minimum of cost [rad^2]", "{:.9g}", &identify::Minimum::cost},
      {"", "found", "starts that found it", "{}", &identify::Minimum::found},
  };
  for (std::size_t k = 0; k < kConstants; ++k)
    out.push_back({"", kConstantNames[k], kConstantNames[k], "{:.5g}", [k](auto& m) { return constants(m.sea)[k]; }});
  return out;
}

/// The rung with the smallest held-out residual; null where none was computed.
const identify::Rung* best_held_out(const identify::Ladder& ladder) {
  const identify::Rung* best = nullptr;
  for (const identify::Rung& r : ladder.rungs)
    if (std::isfinite(r.held_out) && (!best || r.held_out < best->held_out)) best = &r;
  return best;
}

/// Which model to choose, as a command-line option.
std::string model_advice(const identify::Ladder& ladder) {
  const identify::Rung& by_bic = ladder.rungs[ladder.preferred];
  const identify::Rung* by_trials = best_held_out(ladder);
  const auto option = [](const identify::Rung& r) {
    const std::vector<std::string>& terms = r.options.terms.nuisance;
    return terms.empty() ? "no --nuisance" : fmt::format("--nuisance {}", fmt::join(terms, ","));
  };
  if (!by_trials || by_trials == &by_bic)
    return fmt::format("Take this model: `{}`. BIC{} it.", option(by_bic),
                       by_trials ? " and the trials held out both prefer" : " prefers");
  return fmt::format(
      "BIC prefers the model `{}`; trials held out are predicted best with `{}` ({:.4g} rad rms against {:.4g}): take "
      "that.",
      option(by_bic), option(*by_trials), by_trials->held_out, by_bic.held_out);
}

/// Recommended next steps, a sentence each.
std::vector<std::string> next_steps(const IdentifyQuestion& q, const identify::Identification& found) {
  const Fit& fit = found.fit;
  if (!found.trust) return {"Nothing was found: give a --start, or more trials."};
  std::vector<std::string> out;
  if (fit.flawed_logs) out.emplace_back("Mend the logs first: the warnings say where.");
  if (found.trust->tests.model_rejected())
    out.emplace_back(
        "Try the term that the tests miss (--nuisance), and `ukemi identify --diagnose` to compare models.");
  if (found.trust->ladder) out.push_back(model_advice(*found.trust->ladder));
  for (const identify::Estimate& e : fit.parameters)
    if (e.free && e.verdict != identify::Identifiability::kTrusted) {
      out.emplace_back("Make the hits that say most of what is still unknown: `ukemi design` proposes them.");
      break;
    }
  if (q.trials.size() > 1 && !found.trust->ladder)
    out.push_back(fmt::format("Validate on a trial that was not fitted: `ukemi predict{}`.",
                              found.force_smooth > 0 ? " --force-curve smooth" : ""));
  if (fit.trusted()) out.emplace_back("Plan with it: `ukemi optimize SCENE.toml --actuator actuator.toml`.");
  return out;
}

/// Reports the effect of the fit's errors on a landing.
void report_part(const LandingOfFit& l, const Fit& fit, Report& report, Json& summary, Run& run) {
  summary["landing"] = {{"peak", number(l.peak)},          {"mean", number(l.mean)}, {"deviation", number(l.deviation)},
                        {"cvar90", number(l.worst_tenth)}, {"landings", l.samples},  {"failed", l.failed}};
  std::string text = fmt::format("landing: peak {:.4g} m/s^2 with the fitted constants", l.peak);
  if (l.samples > 0)
    text += fmt::format(
        "; over the errors of the five constants {:.4g} +- {:.2g} m/s^2 (mean and standard deviation of {} landings), "
        "worst tenth {:.4g}",
        l.mean, l.deviation, l.samples, l.worst_tenth);
  else if (l.failed == 0)
    text += "; the fit tells no errors of them";
  run.say(text);
  report.heading("What it means for the landing");
  if (l.samples > 0 && fit.trusted())
    text += ". Everything else is as planned: the standard deviation is what more measuring could take away";
  report.paragraph(text + ".");
  if (l.failed > 0)
    run.warn(fmt::format("landing: {} of the drawn actuators gave none that could be followed", l.failed));
}

void warn(const identify::Identification& found, Run& run) {
  const Fit& fit = found.fit;
  for (const std::string& w : fit.warnings) run.warn(w);
  if (!fit.converged && !fit.interrupted)
    run.warn("not converged: " + fit.message + "; try another --start, more trials, or fewer --free constants");
  if (!found.trust) run.warn("nothing was found: no actuator.toml is written");
  if (found.trust && !fit.interrupted) warn(*found.trust, fit, run);
}

}  // namespace

std::string assumptions(const IdentifyQuestion& q, const identify::Identification* found) {
  using Kind = identify::Drive::Kind;
  if (q.rig.drive.kind != Kind::kGains)
    return q.rig.drive.kind == Kind::kCommand
               ? "the motor's torque is k_t times the logged command: no k_p, no k_d"
               : fmt::format("the motor's torque is k_t times the rig's own controller{}: no k_p, no k_d",
                             q.rig.drive.known_command() ? ", which is fed the logged angle" : "");
  return fmt::format("tau_max: {}; Eq. 3 feeds back the {} angle ({})",
                     std::isfinite(q.base.tau_max)
                         ? fmt::format("{:g} Nm ({})", q.base.tau_max, q.rig.tau_max ? "rig" : "actuator")
                         : std::string("no limit (neither rig nor actuator names one)"),
                     ukemi::name(found ? found->fit.sea.feedback : q.base.feedback),
                     q.rig.feedback             ? "rig"
                     : found && found->feedback ? "the better fit of both sides"
                     : q.given                  ? "actuator"
                                                : "default");
}

Quantities<identify::TrialResult> trial_quantities() {
  return {
      {"", "file", "file", {}, &identify::TrialResult::file},
      {"", "samples", "samples", {}, &identify::TrialResult::samples},
      {"", "t_origin", &identify::TrialResult::t_origin},
      {"", "rms", "residual rms [rad]", "{:.4g}", &identify::TrialResult::rms},
      {"", "rms_rate", "of its rate [rad/s]", "{:.4g}", &identify::TrialResult::rms_rate},
      {"", "rms_torque", "of its torque [Nm]", "{:.4g}", &identify::TrialResult::rms_torque},
      {"", "noise", "log's own noise [rad]", "{:.4g}", &identify::TrialResult::noise},
      {"", "", "rollout", {}, [](auto& t) { return name(t.status); }},
  };
}

std::string fit_csv(const Run& run, const std::vector<Trial>& trials, const Fit& fit,
                    const identify::Judgement* judged) {
  // An output of a trial: measured, predicted, half-width of its band. An output that no trial measured has no columns.
  struct Column {
    const char *name, *band;
    std::vector<double> Trial::*measured;
    std::vector<double> identify::TrialResult::*predicted;
    std::vector<double> identify::JudgedTrial::*half;
  };
  std::vector<Column> columns = {
      {"phi", "band", &Trial::phi, &identify::TrialResult::phi, &identify::JudgedTrial::phi},
      {"phi_motor", "band_motor", &Trial::phi_motor, &identify::TrialResult::phi_m, &identify::JudgedTrial::phi_m},
      {"torque", "band_torque", &Trial::torque, &identify::TrialResult::torque, &identify::JudgedTrial::torque}};
  const auto logged = [&](const Column& c) {
    return std::any_of(trials.begin(), trials.end(), [&](const Trial& t) { return !(t.*c.measured).empty(); });
  };
  std::erase_if(columns, [&](const Column& c) { return c.measured != &Trial::phi && !logged(c); });
  CsvWriter csv = run.csv();
  csv.comment(std::string("residual = phi_sim - phi; trial counts from 1, t from its first row. Units: s, rad, Nm.") +
              (judged ? " band: half of the 95 % band about the prediction." : ""));
  for (std::size_t m = 0; m < trials.size(); ++m)
    if (trials[m].t_origin != 0)
      csv.comment(fmt::format("trial {}: t = 0 at {} s of its log", m + 1, shortest(trials[m].t_origin)));
  std::vector<std::string> header = {"trial", "t"};
  for (const Column& c : columns) {
    const std::string name = c.name, residual = "residual" + std::string(c.band).substr(4);
    header.insert(header.end(), {name, name + "_sim", residual});
    if (judged) header.emplace_back(c.band);
  }
  csv.header(header);
  const auto at = [](const std::vector<double>& v, std::size_t i) { return v.empty() ? NAN : v[i]; };
  for (std::size_t m = 0; m < trials.size(); ++m)
    for (std::size_t i = 0; i < trials[m].samples(); ++i) {
      csv.cell(long(m + 1)).cell(trials[m].t[i]);
      for (const Column& c : columns) {
        const double measured = at(trials[m].*c.measured, i), predicted = at(fit.trials[m].*c.predicted, i);
        csv.cell(measured).cell(predicted).cell(predicted - measured);
        if (judged) csv.cell(at(judged->trials[m].*c.half, i));
      }
      csv.end_row();
    }
  return csv.text();
}

SeaParameters<double> base_of(const identify::Rig& rig, const std::optional<Actuator>& given) {
  return rig.mounted(given ? given->sea : SeaParameters<double>{});
}

void choose_drive(IdentifyQuestion& q) {
  using Kind = identify::Drive::Kind;
  std::size_t known = 0;
  for (const identify::Trial& t : q.trials) known += t.rig_or(q.rig).drive.kind != Kind::kGains;
  if (known == 0) return;
  if (known != q.trials.size())
    throw InputError("--trial-rig: some trials have a [drive] and others none: K_p, K_d and K_t cannot be told apart");
  identify::Terms<identify::RigTerm>& terms = q.options.terms;
  std::erase_if(terms.free, [](const std::string& name) { return name == "k_p" || name == "k_d"; });
  q.base.k_p = q.base.k_d = 0;
  if (q.verb == IdentifyQuestion::Verb::kIdentify && !terms.fits("k_t"))
    terms.nuisance.insert(terms.nuisance.begin(), "k_t");
  q.options.validate();
}

Actuator fitted_actuator(const IdentifyQuestion& q, const Fit& fit) {
  Actuator out;
  out.name = fmt::format("identified from {} trials", q.trials.size());
  out.sea = fit.sea;
  if (q.given) out.speed_max = q.given->speed_max;
  if (q.given) out.motor_torque_max = q.given->motor_torque_max;
  if (q.rig.speed_max) out.speed_max = q.rig.speed_max;
  if (q.rig.motor_torque_max) out.motor_torque_max = q.rig.motor_torque_max;
  for (const identify::Estimate& e : fit.parameters) out.verdicts.emplace_back(e.name, identify::name(e.verdict));
  // The covariance is of the determined constants of the actuator only: a file cannot hold NaN.
  std::vector<long> determined;
  for (long i = 0; i < fit.covariance.rows(); ++i) {
    const std::string& key = q.options.terms[fit.fitted[std::size_t(i)]].key;
    if (!std::isfinite(fit.covariance(i, i)) || key.empty()) continue;
    determined.push_back(i);
    out.uncertain.push_back(key);
  }
  out.covariance = Eigen::MatrixXd(eigen(fit.covariance)(determined, determined));
  return out;
}

std::vector<Series> angle_curves(const Trial& t, const identify::TrialResult& predicted) {
  std::vector<Series> series;
  const auto add = [&](const char* name, const std::vector<double>& phi) {
    if (!phi.empty()) series.push_back({name, t.t, phi});
  };
  add("measured", t.phi), add("predicted", predicted.phi);
  if (!t.phi_motor.empty()) add("motor, measured", t.phi_motor), add("motor, predicted", predicted.phi_m);
  return series;
}

namespace {

/// actuator.toml, and the files for other programs.
void write_actuator(const IdentifyQuestion& q, const Fit& fit, Run& run) {
  const RigLink link{q.rig.length, q.rig.inertia};
  Actuator actuator = fitted_actuator(q, fit);
  for (auto& [name, content] : exported(q.exports, actuator, link, run)) run.add(name, content);
  actuator.provenance = run.provenance();
  actuator.provenance.emplace_back("converged", fit.converged ? "true" : "false: these constants are not a minimum");
  run.add("actuator.toml", to_toml(actuator, fit.half_width));
}

FirstScreen answer_of(const IdentifyQuestion& q, const identify::Identification& found) {
  const Fit& fit = found.fit;
  FirstScreen first = first_screen(fit, fmt::format("{} trials", q.trials.size()));
  first.sentence += fmt::format(" The angles are met within {:.2g} rad (rms).", fit.rms);
  if (found.trust)
    first.checks.push_back(check(!found.trust->tests.model_rejected(), "the model explains the trials", ""));
  const std::string unrated = fitted_actuator(q, fit).unknown_ratings();
  first.checks.push_back(
      {unrated.empty() ? Check::State::kGood : Check::State::kUnknown, "the motor's ratings", unrated});
  first.checks.push_back({Check::State::kUnknown, "held-out trial", "not played here"});
  first.next = "`ukemi predict` with actuator.toml and a trial that was held out tests these constants.";
  return first;
}

}  // namespace

int report(const IdentifyQuestion& q, const identify::Identification& found, const std::optional<LandingOfFit>& landing,
           Doubt doubt, Json summary, Run& run) {
  const Fit& fit = found.fit;
  warn(found, run);
  Report report("Identification");
  begin_report(fit, constant_quantities(), report, summary, run);
  run.say(assumptions(q, &found));
  if (const std::string unknown = fitted_actuator(q, fit).unknown_ratings(); !unknown.empty())
    run.say("the motor's ratings are unknown (" + unknown + "): --speed-max, --motor-torque-max, or the rig's keys");
  report.figure(constants_figure(fit.parameters));
  const Table minima(minimum_quantities(), fit.minima), trials(trial_quantities(), fit.trials);
  if (q.options.explore > 0) run.say(fmt::format("{} starts", fit.starts)), say(minima, run);
  run.say(fmt::format("residual rms {:.6g} rad over {} trials", fit.rms, q.trials.size()));
  if (fit.correlation.rows() > 1) {
    std::string eigenvalues = "Eigenvalues of the scaled Fisher information, largest 1:";
    for (const double e : fit.eigenvalues) eigenvalues += fmt::format(" {:.3g}", e);
    report.paragraph(eigenvalues);
  }
  if (found.force_smooth > 0)
    run.say(
        "the force between its samples: a smooth curve through each pulse (predict, compare and design take it with "
        "--force-curve smooth)");
  summary["force_curve"] = found.force_smooth > 0 ? "smooth" : "linear";
  summary["rms"] = number(fit.rms);
  summary["identifiable"] = fit.identifiable;
  summary["trusted"] = fit.trusted();
  report_error_budget(q.rig, fit, report, summary, run);
  if (found.trust) report_part(*found.trust, fit, report, summary, run);
  if (found.trust && found.trust->ladder) run.say(model_advice(*found.trust->ladder));
  if (landing) report_part(*landing, fit, report, summary, run);
  summary["minima"] = minima.objects();
  summary["assumed"] = assumptions(q, &found);
  summary["trials"] = trials.objects();
  report.heading("Trials");
  report.table(trials);
  report.figure(trials_figure(q.trials, fit));
  for (Figure& f : residual_figures(q.trials, fit)) report.figure(std::move(f));
  if (const std::vector<std::string> next = next_steps(q, found); !next.empty())
    report.heading("What to do next"), report.list(next);
  if (found.trust) write_actuator(q, fit, run);
  run.add("fit.csv", fit_csv(run, q.trials, fit));
  report.answer(answer_of(q, found), run.warnings());
  report.write(run);
  const bool doubted = doubt == Doubt::kFail && !fit.trusted();
  return run.finish(summary, fit.converged && !doubted ? kDone : kNumbers);
}

}  // namespace ukemi::tools

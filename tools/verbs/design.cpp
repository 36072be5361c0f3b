// ukemi design: which hit to try next.
#include "identify/design/design.hpp"

#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "common/error.hpp"
#include "tools/program/actuators.hpp"
#include "tools/program/arguments.hpp"
#include "tools/report/report.hpp"
#include "tools/verbs/verbs.hpp"

namespace ukemi::tools {

namespace {

struct DesignArguments {
  std::vector<std::string> trials;
  std::string rig, actuator, criterion = "worst", directions = "both";
  TrialArguments reading;
  identify::HitBudget budget;
  std::vector<double> width = {0.010, 0.020};
  identify::HitLog log;
  std::optional<double> noise, tau_max;
  int hits = 2, check = 50;
};

identify::Criterion criterion_of(const std::string& text) {
  using enum identify::Criterion;
  return choice<identify::Criterion>("--criterion", text, {{"worst", kWorst}, {"d", kD}, {"e", kE}});
}
identify::HitBudget::Directions directions_of(const std::string& text) {
  using enum identify::HitBudget::Directions;
  return choice<identify::HitBudget::Directions>("--directions", text, {{"both", kAlternate}, {"positive", kPositive}});
}

std::string percent(double relative) {
  return std::isfinite(relative) ? fmt::format("{:.3g} %", 100 * relative) : std::string("not determined");
}
const char* constant_name(const identify::Knowledge& k, std::size_t i) {
  return kConstantNames[std::size_t(k.constants[i])];
}
std::string words(const identify::Hit& hit) { return fmt::format("{:.1f} N for {:.2f} ms", hit.peak, 1e3 * hit.width); }

Json hit_json(const identify::Hit& hit) { return {{"peak", number(hit.peak)}, {"width", number(hit.width)}}; }
Json hit_json(const identify::ProposedHit& h, const identify::DesignOptions& o) {
  Json j = hit_json(h.hit);
  j["start"] = o.log.start;
  j["angle"] = number(h.safety.angle);
  j["angle_within_uncertainty"] = number(h.safety.worst_angle);
  j["margin"] = number(o.budget.angle - h.safety.worst_angle);
  j["spring_torque"] = number(h.safety.torque);
  j["time_at_limit"] = number(h.safety.limited);
  return j;
}

std::string hits_csv(const Run& run, const identify::Design& d, const identify::DesignOptions& o) {
  CsvWriter csv = run.csv();
  csv.comment(
      "Proposed half-sine hits at the tip. angle_worst: largest |phi_1| within the estimate's 95 % ellipsoid; torque: "
      "largest of the spring before the limit; limited: how long the limit acts. Units: N, s, rad, Nm.");
  csv.header({"hit", "peak", "width", "start", "angle", "angle_worst", "torque", "limited"});
  for (std::size_t i = 0; i < d.hits.size(); ++i) {
    const auto& h = d.hits[i];
    csv.row({double(i + 1), h.hit.peak, h.hit.width, o.log.start, h.safety.angle, h.safety.worst_angle, h.safety.torque,
             h.safety.limited});
  }
  return csv.text();
}

std::string force_csv(const Run& run, const identify::Trial& log) {
  CsvWriter csv = run.csv();
  csv.comment("The force to play at the link's tip, linear between samples. Units: s, N.");
  csv.header({"t", "force"});
  for (std::size_t i = 0; i < log.samples(); ++i) csv.row({log.t[i], log.force[i]});
  return csv.text();
}

std::string report_html(const Run& run, const identify::Rig& rig, const identify::Knowledge& k,
                        const identify::Design& d, const identify::DesignOptions& o,
                        const std::optional<identify::DesignCheck>& check) {
  Report report("The next hits");
  report.paragraph(d.status == identify::Design::Status::kDone ? "Done." : d.message);
  report.list(run.warnings());
  report.heading("Error bars, 95 %, relative");
  std::vector<std::vector<std::string>> rows;
  const auto u = constants(k.sea);
  for (std::size_t i = 0; i < k.constants.size(); ++i)
    rows.push_back({constant_name(k, i), fmt::format("{:.6g}", u[std::size_t(k.constants[i])]),
                    kConstantUnits[std::size_t(k.constants[i])], percent(d.before[long(i)]),
                    d.hits.empty() ? "" : percent(d.after[long(i)])});
  report.table({"constant", "estimate", "unit", "before", "after, predicted"}, rows);
  if (d.hits.empty()) return report.html(run.provenance());
  report.heading("Hits");
  rows.clear();
  for (const auto& h : d.hits)
    rows.push_back({words(h.hit), fmt::format("{:.4f}", h.safety.angle), fmt::format("{:.4f}", h.safety.worst_angle),
                    fmt::format("{:.1f}", h.safety.torque), fmt::format("{:.1f}", 1e3 * h.safety.limited)});
  report.table({"hit", "largest |phi_1| [rad]", "within the uncertainty [rad]", "spring torque before the limit [Nm]",
                "at the limit [ms]"},
               rows);
  std::vector<identify::Trial> logs;
  for (const auto& h : d.hits) logs.push_back(identify::blank_log(h.hit, o.log));
  const identify::Fit motion = identify::predict(rig, logs, k.sea);
  std::vector<Series> forces, angles;
  for (std::size_t i = 0; i < logs.size(); ++i) {
    forces.push_back({words(d.hits[i].hit), logs[i].t, logs[i].force});
    angles.push_back({words(d.hits[i].hit), logs[i].t, motion.trials[i].phi});
  }
  report.plot("t [s]", "force [N]", forces);
  report.plot("t [s]", "phi_1, predicted [rad]", angles);
  report.heading("Runners-up");
  rows.clear();
  for (const auto& r : d.runners_up) {
    std::string text;
    for (const auto& h : r.hits) text += (text.empty() ? "" : "; ") + words(h);
    rows.push_back({text, fmt::format("{:.2f}", r.size / d.size_after)});
  }
  report.table({"hits", "criterion against the proposal's"}, rows);
  if (check) {
    report.heading("Check by simulation");
    report.paragraph(
        fmt::format("{} experiments simulated at the estimate and refitted: {}.", check->repeats,
                    check->agrees ? "the predicted bars come true" : "the predicted bars do not come true"));
    rows.clear();
    for (std::size_t i = 0; i < k.constants.size(); ++i) {
      const auto& c = check->constants[i];
      rows.push_back({constant_name(k, i), percent(c.predicted), percent(c.scatter), percent(c.half_width),
                      fmt::format("{} of {}", c.covered, check->repeats)});
    }
    report.table({"constant", "standard error, predicted", "scatter of the refits", "their mean 95 % half-width",
                  "intervals that hold the truth"},
                 rows);
  }
  return report.html(run.provenance());
}

int run_design(const DesignArguments& a, const CommonOptions& common) {
  Run run("design", common);
  const identify::Rig rig = identify::read_rig(a.rig);
  run.input(a.rig);
  Actuator actuator = actuator_of(a.actuator, run);
  identify::DesignOptions o{.budget = a.budget, .log = a.log, .hits = a.hits, .criterion = criterion_of(a.criterion)};
  o.budget.min_width = a.width.front(), o.budget.max_width = a.width.back();
  o.budget.directions = directions_of(a.directions);
  o.seed = common.seed, o.threads = common.threads;
  TrialInputs inputs;
  if (!a.trials.empty())
    inputs = read_trials(a.trials, a.reading, rig, {.excitation = TrialNeeds::Excitation::kRequired}, run);
  const std::vector<identify::Trial>& trials = inputs.trials;
  if (trials.empty() && !a.noise) throw InputError("--noise: without trials the noise of the angle [rad] is needed");
  o.log.noise = a.noise ? *a.noise : identify::noise_level(trials);
  if (!(o.log.noise > 0) && !a.noise)
    throw InputError("--noise: the trials show none: the noise of the angle [rad] is needed");
  for (const identify::Trial& t : trials)
    if (!t.phi_motor.empty()) o.log.outputs = identify::HitLog::Outputs::kLinkAndMotor;
  o.validate();
  actuator.sea.tau_max = a.tau_max.value_or(rig.tau_max.value_or(actuator.sea.tau_max));
  actuator.sea.feedback = rig.feedback.value_or(actuator.sea.feedback);

  const std::vector<int> uncertain = identify::uncertain_constants(actuator);
  if (uncertain.empty()) throw InputError({a.actuator}, "no uncertain constant above 0: there is nothing to shrink");
  const std::optional<identify::Knowledge> knowledge =
      trials.empty() ? identify::knowledge_of(actuator)
                     : identify::knowledge_of(rig, actuator.sea, uncertain, trials, o.log.noise);
  if (!knowledge)
    throw InputError({a.actuator}, "no covariance of the constants, or a singular one: give the trials in hand");
  const identify::Knowledge& k = *knowledge;
  if (actuator.sea.friction != 0 || actuator.sea.k_sea_cubic != 0)
    run.warn("friction and stiffening are taken as known: only the five constants are designed for");
  if (!trials.empty()) {
    const double rms = identify::predict(rig, trials, actuator.sea).rms;
    if (rms > identify::kFarAboveNoise * o.log.noise)
      run.warn(fmt::format("the actuator misses these trials by {:.3g} rad, {:.1f} times the noise: fit them first",
                           rms, rms / o.log.noise));
  }

  run.info(fmt::format("looking for {} hits", o.hits));
  const identify::Design d = identify::design(rig, k, o);
  const bool found = d.status == identify::Design::Status::kDone;
  if (!found) run.warn(d.message);
  std::optional<identify::DesignCheck> check;
  if (found && a.check > 0) {
    run.info(fmt::format("checking by {} simulated experiments", a.check));
    std::vector<identify::Hit> hits;
    for (const auto& h : d.hits) hits.push_back(h.hit);
    check = identify::check(rig, k, trials, hits, o, a.check);
    if (!check->agrees) run.warn("the simulated experiments scatter otherwise than predicted: see the check");
  }

  Json summary = std::move(inputs.summary);
  summary["criterion"] = {
      {"name", name(o.criterion)}, {"before", number(d.size_before)}, {"after", number(d.size_after)}};
  const auto u = constants(k.sea);
  for (std::size_t i = 0; i < k.constants.size(); ++i) {
    Json c{{"value", number(u[std::size_t(k.constants[i])])},
           {"unit", kConstantUnits[std::size_t(k.constants[i])]},
           {"half_width_before", number(d.before[long(i)])},
           {"half_width_after", found ? number(d.after[long(i)]) : Json(nullptr)}};
    run.say(fmt::format("{:8} 95 %: ± {}{}", constant_name(k, i), percent(d.before[long(i)]),
                        found ? " -> " + percent(d.after[long(i)]) : ""));
    summary["constants"][constant_name(k, i)] = c;
  }
  summary["in_hand"] = trials.empty() ? "the actuator's covariance" : fmt::format("{} trials", trials.size());
  summary["noise"] = number(o.log.noise);
  summary["tau_max"] = number(k.sea.tau_max);
  summary["hits"] = summary["runners_up"] = Json::array();
  for (std::size_t i = 0; i < d.hits.size(); ++i) {
    const auto& h = d.hits[i];
    summary["hits"].push_back(hit_json(h, o));
    run.say(
        fmt::format("hit {}: {}; |phi_1| up to {:.4f} rad, {:.4f} within the uncertainty; {:.1f} ms at the torque "
                    "limit",
                    i + 1, words(h.hit), h.safety.angle, h.safety.worst_angle, 1e3 * h.safety.limited));
    run.add(fmt::format("hit_{}.csv", i + 1), force_csv(run, identify::blank_log(h.hit, o.log)));
  }
  for (const auto& r : d.runners_up) {
    Json hits = Json::array();
    for (const auto& h : r.hits) hits.push_back(hit_json(h));
    summary["runners_up"].push_back({{"hits", hits}, {"criterion", number(r.size)}});
  }
  summary["candidates"] = {{"looked_at", d.candidates}, {"beyond_the_angle", d.too_far}, {"escaping", d.escaping}};
  summary["check"] = nullptr;
  if (check) {
    Json of_constants;
    for (std::size_t i = 0; i < k.constants.size(); ++i) {
      const auto& c = check->constants[i];
      of_constants[constant_name(k, i)] = {{"std_predicted", number(c.predicted)},
                                           {"scatter", number(c.scatter)},
                                           {"half_width", number(c.half_width)},
                                           {"covered", c.covered}};
    }
    summary["check"] = {
        {"repeats", check->repeats}, {"failed", check->failed}, {"agrees", check->agrees}, {"constants", of_constants}};
    run.say(fmt::format("check: {} simulated experiments, {} failed: the predicted bars {}", check->repeats,
                        check->failed, check->agrees ? "come true" : "do not come true"));
  }
  if (found) run.add("hits.csv", hits_csv(run, d, o));
  run.add("report.html", report_html(run, rig, k, d, o, check));
  return run.finish(summary, found && (!check || check->agrees) ? kDone : kNumbers);
}

}  // namespace

void add_design(CLI::App& app, Action& chosen) {
  auto args = std::make_shared<DesignArguments>();
  auto common = std::make_shared<CommonOptions>();
  CLI::App* verb = app.add_subcommand("design", "propose the hits that shrink the constants' error bars most");
  verb->add_option("TRIAL", args->trials, "trials in hand [none: what is known is the actuator's covariance]");
  verb->add_option("--rig", args->rig, "rig file (TOML)")->required();
  verb->add_option("--actuator", args->actuator, "actuator file (TOML): the present estimate")->required();
  verb->add_option("--peak", args->budget.peak, "largest force of a hit [N] [300]");
  verb->add_option("--width", args->width, "shortest and longest pulse [s] [0.010 0.020]")->expected(1, 2);
  verb->add_option("--angle", args->budget.angle,
                   "largest |phi_1| [rad], kept wherever the constants may lie within their uncertainty [0.6]");
  verb->add_option("--hits", args->hits, "how many hits, each a trial of its own [2]");
  verb->add_option("--criterion", args->criterion,
                   "what becomes smallest: worst (the worst-known constant's interval), d (the volume of the "
                   "ellipsoid), e (its longest axis) [worst]");
  verb->add_option("--directions", args->directions, "both (hits alternate) or positive [both]");
  verb->add_option("--rate", args->log.rate, "of the next logs [Hz] [1000]");
  verb->add_option("--duration", args->log.duration, "of the next logs [s] [1]");
  verb->add_option("--noise", args->noise, "standard deviation of an angle [rad] [the trials' own]");
  verb->add_option("--tau-max", args->tau_max, "torque limit of the spring [Nm] [the rig's, else the actuator's]")
      ->check(CLI::NonNegativeNumber);
  verb->add_option("--check", args->check, "simulated experiments that test the prediction, 0: none [50]")
      ->check(CLI::Range(0, 100000));
  add_trial_options(*verb, args->reading);
  add_common(*verb, *common);
  verb->footer(
      "Example: ukemi design trial_1.csv trial_2.csv --rig rig.toml --actuator out/identify/actuator.toml --peak 300 "
      "--width 0.010 0.020 --angle 0.6 -o out/design");
  verb->callback([args, common, &chosen] { chosen = [args, common] { return run_design(*args, *common); }; });
}

}  // namespace ukemi::tools

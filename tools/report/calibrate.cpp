#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "landing/model/scene_file.hpp"
#include "tools/program/interrupt.hpp"
#include "tools/report/body_scene_text.hpp"
#include "tools/report/calibrate.hpp"
#include "tools/report/estimates.hpp"
#include "tools/report/landing.hpp"
#include "tools/report/results.hpp"
#include "tools/study/baselines.hpp"
#include "tools/study/calibration.hpp"

namespace ukemi::tools {

const Outputs kCalibrateOutputs{"calibrate",
                                {"scene.toml", "robot.toml", "fit.csv", "validation.csv", "profile.csv"},
                                {"drop_#", "validation_#", "profile_#"}};

using namespace landing;

namespace {

/// Stated errors of unfitted constants: "link.arm.mass 0.01 kg".
std::string errors_in_words(const FloorFit& c) {
  std::vector<std::string> out;
  for (const identify::Considered& error : c.considered)
    for (const identify::Estimate& e : c.parameters)
      if (e.name == error.name && !e.free) out.push_back(fmt::format("{} {:.3g} {}", error.name, error.std, e.unit));
  return out.empty() ? "none, exact" : fmt::format("{}", fmt::join(out, ", "));
}

/// Share of an output's used samples within the fit's 95 % band; NaN where there is no band.
double within_band(const FitTexts& c, std::size_t output) {
  double count = 0, within = 0;
  for (std::size_t m = 0; m < c.result.bands.size(); ++m) {
    const DropResult& d = c.result.drops[m];
    for (std::size_t i = 0; c.result.bands[m].known() && i < d.value[output].size(); ++i)
      if (d.used[output][i])
        count += 1,
            within += std::abs(d.value[output][i] - c.logs[m]->output[output][i]) <= c.result.bands[m].band[output][i];
  }
  return count > 0 ? within / count : std::numeric_limits<double>::quiet_NaN();
}

/// Columns of an output, given by its index, over all drops.
Quantities<std::size_t> output_quantities(const FitTexts& texts) {
  const FloorFit& c = texts.result;
  Quantities<std::size_t> out = {
      {"", "", "output", {}, [&c](auto& o) { return c.channels[o].name; }},
      {"", "rms", "residual rms", "{:.3g}", [&c](auto& o) { return c.rms[o]; }},
      {"", "noise", "the logs' noise", "{:.3g}", [&c](auto& o) { return c.noise[o]; }},
      {"", "unit", "unit", {}, [&c](auto& o) { return c.channels[o].unit; }},
  };
  if (!c.bands.empty())
    out.push_back({"", "within_band", "within the 95 % band", percent_words,
                   [&texts](auto& o) { return number(within_band(texts, o)); }});
  return out;
}
std::vector<std::size_t> measured_outputs(const FloorFit& c) {
  std::vector<std::size_t> out;
  for (std::size_t o = 0; o < c.channels.size(); ++o)
    if (std::isfinite(c.noise[o])) out.push_back(o);
  return out;
}

Quantities<DropResult> drop_quantities(const FloorFit& c) {
  Quantities<DropResult> out = {{"", "file", words(c.logs_of).one, {}, &DropResult::file},
                                {"", "simulated", &DropResult::simulated}};
  for (const std::size_t o : measured_outputs(c))
    out.push_back({"", "rms/" + c.channels[o].name, fmt::format("{} rms [{}]", c.channels[o].name, c.channels[o].unit),
                   "{:.3g}", [o](auto& d) { return d.rms[o]; }});
  const auto& drops = c.drops;
  if (std::all_of(drops.begin(), drops.end(), [](auto& d) { return std::isnan(d.peak_between); })) return out;
  if (c.logs_of == LogsOf::kTrials) {
    out.push_back({"", "peak_simulated", "largest acceleration [m/s^2]", "{:.4g}", &DropResult::peak_between});
    return out;
  }
  out.push_back({"", "peak_measured", "peak measured [m/s^2]", "{:.4g}", &DropResult::peak_measured});
  out.push_back({"", "peak_simulated", "simulated at the samples [m/s^2]", "{:.4g}", &DropResult::peak_simulated});
  out.push_back({"", "peak_between_samples", "and between them [m/s^2]", "{:.4g}", &DropResult::peak_between});
  return out;
}

std::string samples_csv(const Run& run, const FitTexts& c) {
  CsvWriter csv = run.csv();
  csv.comment(fmt::format(
      "residual = simulated - measured; {} counts from 1; t as in the log; used 0: left out, an acceleration within a "
      "sampling interval of a simulated touchdown or lift-off. Units: s, m, rad, m/s^2.",
      words(c.result.logs_of).one));
  std::vector<std::string> header = {
      words(c.result.logs_of).one, "t", "output", "measured", "simulated", "residual", "used"};
  const bool promised = !c.result.bands.empty();
  if (promised)
    csv.comment("band: half of the 95 % band about what is simulated: the constants' errors and what the fit left.");
  if (promised) header.push_back("band");
  csv.header(header);
  for (std::size_t m = 0; m < c.logs.size(); ++m)
    for (std::size_t o = 0; o < c.result.channels.size(); ++o) {
      const DropResult& result = c.result.drops[m];
      for (std::size_t i = 0; i < result.value[o].size(); ++i) {
        const double log = c.logs[m]->output[o][i], simulated = result.value[o][i];
        if (!std::isfinite(log) || !std::isfinite(simulated)) continue;
        csv.cell(long(m + 1)).cell(c.logs[m]->t[i]).cell(c.result.channels[o].name).cell(log).cell(simulated);
        csv.cell(simulated - log).cell(int(result.used[o][i]));
        if (promised) {
          const PredictionBands& p = c.result.bands[m];
          csv.cell(p.known() ? p.band[o][i] : std::numeric_limits<double>::quiet_NaN());
        }
        csv.end_row();
      }
    }
  return csv.text();
}

}  // namespace

std::string scene_comments(const Run& run, const FloorFit& c) {
  std::string comments = run.provenance_text();
  for (const auto& e : c.parameters)
    comments += fmt::format("{}: {}: {}\n", e.name, value_words(e), identify::name(e.verdict));
  if (!c.converged) comments += "not converged: these constants are not a minimum\n";
  return comments;
}

namespace {

/// A drop's outputs side by side, measured and simulated; vertical lines at simulated touchdowns and lift-offs. Named
/// drop_1 or validation_1.
Figure drop_figure(const DropLog& log, const FloorFit& fit, const char* set, std::size_t m) {
  const DropResult& result = fit.drops[m];
  const std::size_t number = m + 1;
  Figure out;
  out.name = fmt::format("{}_{}", set, number), out.width = Figure::Width::kWhole, out.panel_height = 200;
  for (std::size_t o = 0; o < fit.channels.size(); ++o) {
    const std::vector<double>&measured = log.output[o], &simulated = result.value[o];
    if (simulated.empty()) continue;
    Panel p;
    p.title = fit.channels[o].name, p.x_label = "t [s]", p.y_label = fit.channels[o].unit;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const std::vector<double>* values : {&measured, &simulated})
      for (const double v : *values)
        if (std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
    for (const double t : result.jumps)
      p.series.push_back({"", {t, t}, {low, high}, Series::Style::kFaint, Series::kGrey});
    p.series.push_back({"", log.t, measured, Series::Style::kPoints, 0});
    p.series.push_back({"", log.t, simulated, Series::Style::kLine, 1});
    out.panels.push_back(std::move(p));
  }
  out.columns = int(std::min<std::size_t>(4, out.panels.size()));
  out.caption = fmt::format(
      "{} {}, {}: measured (points) and simulated (line); grey: where the simulation touches down and lifts off. All "
      "samples: fit.csv.",
      words(fit.logs_of).one, number, log.file);
  return out;
}

/// Findings of the residual tests, a sentence each.
std::vector<std::string> findings(const FloorFit& c) {
  std::vector<std::string> out;
  const identify::ResidualTests& tests = c.tests;
  if (const identify::ScoreTest* missed = tests.missing()) {
    const std::string& term = missed->term;
    const bool held = std::any_of(c.parameters.begin(), c.parameters.end(), [&](auto& e) { return e.name == term; });
    out.push_back(fmt::format(
        "the {} ask for {}{} (score test, p {}): of what was not fitted it explains most of the residuals, their rms "
        "would fall from {:.4g} to {:.4g} standard deviations: try {}",
        words(c.logs_of).many, held ? "another value of " : "", term, probability_words(missed->p),
        std::sqrt(tests.score->variance), tests.rms_with(*missed), held ? "--free with it" : "--nuisance " + term));
  }
  if (tests.whiteness.rejected) out.push_back(not_white_words(tests));
  for (std::size_t m = 0; m < tests.chow.size(); ++m)
    if (tests.disagrees(m))
      out.push_back(fmt::format("{} disagrees with the other {} (Chow's test, p {}): it asks for a {} of its own",
                                c.drops[m].file, words(c.logs_of).many, probability_words(tests.chow[m]),
                                words(c.logs_of).model));
  if (tests.model_rejected())
    out.push_back(rejected_words(tests, words(c.logs_of).model, words(c.logs_of).many) + ". Every plan rests on it");
  return out;
}

/// "outputs" and "drops" of the summary, their tables, and a figure of each drop.
void report_drops(const FitTexts& c, const char* set, Report& report, Json& summary, Run& run) {
  const Table outputs(output_quantities(c), measured_outputs(c.result));
  summary["outputs"] = outputs.keyed();
  (void)add_table(outputs, report, run);
  summary[words(c.result.logs_of).many] = add_table(Table(drop_quantities(c.result), c.result.drops), report, run);
  constexpr std::size_t kMaxFigures = 12;
  for (std::size_t m = 0; m < std::min(kMaxFigures, c.logs.size()); ++m)
    report.figure(drop_figure(*c.logs[m], c.result, set, m));
}

constexpr double kMaxRmsOverNoise = 2;  // of drops that were not fitted

/// Largest rms / noise over the outputs; NaN where no noise is known.
double rms_over_noise(const FloorFit& c) {
  double out = std::nan("");
  for (std::size_t o = 0; o < std::min(c.rms.size(), c.noise.size()); ++o)
    if (c.noise[o] > 0) out = std::fmax(out, c.rms[o] / c.noise[o]);
  return out;
}

}  // namespace

int report(const FitTexts& fitted, const std::optional<FitTexts>& validation, Doubt doubt,
           const std::map<std::string, std::string>& files, const std::function<void(Report&, Json&)>& laws, Run& run) {
  const FloorFit& c = fitted.result;
  for (const std::string& w : c.warnings) run.warn(w);
  for (const std::string& finding : findings(c)) run.warn(finding);
  if (!c.converged && !interrupted())
    run.warn("not converged: " + c.message + "; try another start in the file, --prior, or fewer --free constants");
  const FitWords texts = words(c.logs_of);
  Report report(texts.title);
  Json summary;
  bool converged = c.converged;
  if (validation) {
    for (const std::string& w : validation->result.warnings) run.warn("validation: " + w);
    if (!validation->result.converged) run.warn("validation: " + validation->result.message), converged = false;
  }
  begin_report(c, constant_quantities(), report, summary, run);
  if (!fitted.runs.empty()) summary["runs"] = fitted.runs;
  for (std::size_t r = 0; r < fitted.runs.size(); ++r) run.say(fmt::format("@{}: {}", r + 1, fitted.runs[r]));
  const std::string error_words = errors_in_words(c);
  run.say("errors of what is not fitted, standard deviations (--errors): " + error_words);
  (void)report_error_shares(c, "as far as its error is stated (" + error_words + ")", report, summary, run);
  summary["trusted"] = c.trusted();
  summary["steps"] = c.steps;
  report.heading(fmt::format("Does the {} explain the {}?", texts.model, texts.many));
  report_tests(c.tests, "standard deviations", report, summary["diagnostics"]);
  report_profiles(c.profiles, c, report, summary["diagnostics"], run);
  if (laws) laws(report, summary);
  report.heading(fmt::format("Fitted {}", texts.many));
  report_drops(fitted, texts.one, report, summary, run);
  if (validation) {
    run.say("not fitted:");
    report.heading(fmt::format("Validation: {} that were not fitted", texts.many));
    Json& j = summary["validation"];
    j["nuisance"] = nuisance_json(validation->result.nuisance);
    report_drops(*validation, "validation", report, j, run);
    run.add("validation.csv", samples_csv(run, *validation));
  }
  for (const auto& [name, text] : files) run.add(name, text);
  run.add("fit.csv", samples_csv(run, fitted));
  FirstScreen screen = first_screen(c, fmt::format("{} {}", c.drops.size(), texts.many));
  screen.checks.push_back(
      check(!c.tests.model_rejected(), fmt::format("the {} explains the {}", texts.model, texts.many), ""));
  const double ratio = validation ? rms_over_noise(validation->result) : std::nan("");
  const bool holds = !(ratio > kMaxRmsOverNoise);
  screen.checks.push_back(std::isnan(ratio)
                              ? Check{Check::State::kUnknown, std::string("held-out ") + texts.one,
                                      validation ? "played: see Validation" : "none: --validate names one"}
                              : check(holds, std::string("held-out ") + texts.one,
                                      fmt::format("largest residual {:.2g} times the noise", ratio)));
  if (validation) summary["validation"]["times_noise"] = number(ratio);
  screen.next = texts.next;
  report.answer(screen, run.warnings());
  report.write(run);
  return run.finish(summary, converged && (doubt == Doubt::kReport || (c.trusted() && holds)) ? kDone : kNumbers);
}

namespace {

/// Time of contact of a contact point; touchdown and liftoff are indices into DropResult::changes of the trial.
struct SimulatedStance {
  std::size_t trial;  ///< counts from 1
  int contact;
  std::optional<std::size_t> touchdown, liftoff;  ///< absent: before the first row; after the last
  std::optional<std::size_t> previous_liftoff;    ///< the contact's last liftoff before, as index
};
std::vector<SimulatedStance> simulated_stances(const FloorFit& c) {
  std::vector<SimulatedStance> out;
  for (std::size_t m = 0; m < c.drops.size(); ++m) {
    const std::size_t first = out.size();
    for (std::size_t i = 0; i < c.drops[m].changes.size(); ++i) {
      const ContactChange& change = c.drops[m].changes[i];
      const auto end = out.rend() - long(first), last = std::find_if(out.rbegin(), end, [&](const SimulatedStance&s) {
                                                   return s.contact == change.contact;
                                                 });
      if (change.touches)
        out.push_back({m + 1, change.contact, change.t > 0 ? std::optional(i) : std::nullopt, std::nullopt,
                       last == end ? std::nullopt : last->liftoff});
      else if (last != end && !last->liftoff)
        last->liftoff = i;
    }
  }
  return out;
}
Quantities<SimulatedStance> stance_quantities(const FloorFit& c, const std::vector<std::string>& contacts) {
  Quantities<SimulatedStance> out = {
      {"trial", "trial", "trial", {}, [](auto& s) { return s.trial; }},
      {"contact", "contact", "contact", {}, [&contacts](auto& s) { return contacts[std::size_t(s.contact)]; }}};
  using Change = std::optional<std::size_t> SimulatedStance::*;
  const auto add = [&](const std::string& key, const char* words, Change from, Change to) {
    out.push_back({key, key, std::string(words) + " [s]", "{:.4f}", [&c, from, to](const SimulatedStance& s) -> Json {
                     const auto& changes = c.drops[s.trial - 1].changes;
                     if (!(s.*to) || (from && !(s.*from))) return {};
                     return number(changes[*(s.*to)].t - (from ? changes[*(s.*from)].t : 0));
                   }});
    if (c.bands.empty()) return;
    out.push_back({key + "_band", key + "_band", "+- [s]", "{:.4f}", [&c, from, to](const SimulatedStance& s) -> Json {
                     const PredictionBands& p = c.bands[s.trial - 1];
                     if (!p.known() || !(s.*to) || (from && !(s.*from))) return {};
                     return number(from ? p.half_band(*(s.*from), *(s.*to)) : p.half_band(*(s.*to)));
                   }});
  };
  add("touchdown", "touches from", nullptr, &SimulatedStance::touchdown),
      add("liftoff", "to", nullptr, &SimulatedStance::liftoff);
  add("duration", "for", &SimulatedStance::touchdown, &SimulatedStance::liftoff);
  add("flight", "after a flight of", &SimulatedStance::previous_liftoff, &SimulatedStance::touchdown);
  return out;
}

Quantities<std::size_t> baseline_quantities(const FloorFit& c, const std::vector<Baseline>& all) {
  return {{"", "", "output", {}, [&c](auto& o) { return c.channels[o].name; }},
          {"", "model", "the robot, rms", "{:.3g}", [&all](auto& o) { return all[o].model; }},
          {"", "held", "its first value held", "{:.3g}", [&all](auto& o) { return all[o].held; }},
          {"", "mean", "the mean of the other trials", "{:.3g}", [&all](auto& o) { return all[o].mean; }},
          {"", "unit", "unit", {}, [&c](auto& o) { return c.channels[o].unit; }}};
}

/// Compares each output's residual with those of predictions without physics. Returns the line of the checklist.
Check report_baselines(const FitTexts& played, Report& report, Json& summary, Run& run) {
  const std::vector<Baseline> all = baselines(played.result, played.logs);
  std::vector<std::size_t> outputs;
  std::vector<std::string> not_beaten;
  for (std::size_t o = 0; o < all.size(); ++o) {
    if (!all[o].known()) continue;
    outputs.push_back(o);
    if (all[o].beaten()) continue;
    const bool by_mean = all[o].model >= all[o].mean;
    not_beaten.push_back(played.result.channels[o].name);
    run.warn(fmt::format("{}: {} is nearer than the robot: {:.3g} against {:.3g} {} rms", not_beaten.back(),
                         by_mean ? "the mean of the other trials" : "the first value held",
                         by_mean ? all[o].mean : all[o].held, all[o].model, played.result.channels[o].unit));
  }
  const Table table(baseline_quantities(played.result, all), outputs);
  summary["baselines"] = table.keyed();
  report.heading("Beside predictions that know no physics");
  report.paragraph(
      "Each residual on the same samples. How each trial starts is fitted to it for the robot; the mean knows the "
      "other trials, which the robot does not.");
  (void)add_table(table, report, run);
  return {not_beaten.empty() ? Check::State::kGood : Check::State::kCaution, "nearer than no physics",
          not_beaten.empty() ? "" : fmt::format("not in {}", fmt::join(not_beaten, ", "))};
}

/// Whether the logs lie within the 95 % bands of the constants' errors, as a line of the checklist.
Check check_promises(const FitTexts& played, Run& run) {
  constexpr double kMinWithin = 0.9;  // share of samples within a 95 % band
  constexpr const char* kWhat = "within what its constants' errors promise";
  const std::vector<PredictionBands>& all = played.result.bands;
  if (std::none_of(all.begin(), all.end(), [](const PredictionBands& p) { return p.known(); }))
    return {Check::State::kUnknown, kWhat, "no trial could be followed with other constants"};
  std::vector<std::string> outside;
  for (const std::size_t o : measured_outputs(played.result))
    if (const double within = within_band(played, o); within < kMinWithin) {
      outside.push_back(played.result.channels[o].name);
      run.warn(fmt::format("{}: {:.0f} % of the log within the band that 95 % were promised for", outside.back(),
                           100 * within));
    }
  return check(outside.empty(), kWhat, outside.empty() ? "" : fmt::format("not {}", fmt::join(outside, ", ")));
}

Quantities<ComparedStance> compared_quantities(const FloorFit& c, const std::vector<std::string>& contacts) {
  Quantities<ComparedStance> out = {
      {"trial", "trial", "trial", {}, [](auto& s) { return s.trial + 1; }},
      {"contact", "contact", "contact", {}, [&contacts](auto& s) { return contacts[std::size_t(s.contact)]; }},
      {"touchdown", "touchdown", "touches at [s]", "{:.4f}", [](auto& s) { return number(s.measured.touchdown); }},
      {"touchdown_predicted", "touchdown_predicted", "predicted", "{:.4f}",
       [](auto& s) { return number(s.predicted.touchdown); }},
      {"liftoff", "liftoff", "leaves at [s]", "{:.4f}", [](auto& s) { return number(s.measured.liftoff); }},
      {"liftoff_predicted", "liftoff_predicted", "predicted", "{:.4f}",
       [](auto& s) { return number(s.predicted.liftoff); }}};
  const auto add = [&](const std::string& key, const char* words, double (Stance::*of)() const,
                       double ComparedStance::*others) {
    out.push_back({key, key, words, "{:.4f}", [of](auto& s) { return number((s.measured.*of)()); }});
    out.push_back({key + "_predicted", key + "_predicted", "predicted", "{:.4f}",
                   [of](auto& s) { return number((s.predicted.*of)()); }});
    out.push_back({key + "_of_others", key + "_of_others", "mean of the others", "{:.4f}",
                   [others](auto& s) { return number(s.*others); }});
  };
  add("stance", "stands for [s]", &Stance::duration, &ComparedStance::duration_of_others);
  add("flight", "flight before [s]", &Stance::flight, &ComparedStance::flight_of_others);
  if (c.bands.empty()) return out;
  for (const auto& [key, band] : {std::pair("touchdown_band", &ComparedStance::touchdown_band),
                                  {"stance_band", &ComparedStance::duration_band},
                                  {"flight_band", &ComparedStance::flight_band}})
    out.push_back({key, key, [band = band](auto& s) { return number(s.*band); }});
  return out;
}

Quantities<StanceErrors> error_quantities(const FloorFit& c, const std::vector<std::string>& contacts) {
  const auto percent = [](double part) {
    return std::isnan(part) ? std::string() : fmt::format("{:.3g} %", 100 * part);
  };
  Quantities<StanceErrors> out = {
      {"", "", "contact", {}, [&contacts](auto& e) { return contacts[std::size_t(e.contact)]; }},
      {"", "landings", "landings", {}, &StanceErrors::measured},
      {"", "missed", "not predicted", {}, &StanceErrors::missed},
      {"", "added", "predicted alone", {}, &StanceErrors::added},
      {"", "touchdown/error", "touchdown off [s]", "{:.2g}", [](auto& e) { return number(e.touchdown.absolute); }}};
  const auto add = [&](const std::string& key, TimeErrors StanceErrors::*of) {
    out.push_back({"", key + "/error", key + " off [s]", "{:.2g}", [of](auto& e) { return number((e.*of).absolute); }});
    out.push_back({"", key + "/relative", "relative", +percent, [of](auto& e) { return number((e.*of).relative); }});
    out.push_back({"", key + "/mean_of_others", "mean of the other landings", +percent,
                   [of](auto& e) { return number((e.*of).others); }});
  };
  add("stance", &StanceErrors::duration), add("flight", &StanceErrors::flight);
  for (const auto& [key, of] : {std::pair("touchdown", &StanceErrors::touchdown),
                                {"stance", &StanceErrors::duration},
                                {"flight", &StanceErrors::flight}}) {
    out.push_back({"", std::string(key) + "/count", [of = of](auto& e) { return (e.*of).count; }});
    if (!c.bands.empty())
      out.push_back({"", std::string(key) + "/within_band", [of = of](auto& e) { return number((e.*of).within); }});
  }
  return out;
}

/// Compares measured landings with those of the rollout; warns where the mean of the others is nearer.
void report_landings(const FitTexts& played, const ContactTimes& contacts, Report& report, Json& summary, Run& run) {
  if (contacts.errors.empty()) return;
  report.heading("Landings, measured beside predicted");
  report.paragraph(
      "Both by one rule, from the force across the floor: a contact touches where it rises through a twentieth of the "
      "largest, at most a fifth of the robot's weight, at least six times the log's noise, and leaves where it falls "
      "below half of that. A flight below 10 ms is none. The mean of the other landings knows no physics.");
  const Table errors(error_quantities(played.result, contacts.names), contacts.errors);
  say(errors, run), report.table(errors), summary["landings"] = errors.keyed();
  const Table rows(compared_quantities(played.result, contacts.names), contacts.compared);
  report.table(rows);
  run.add(
      "landings.csv",
      rows.csv(run,
               "a row a stance of a contact whose force the log has; t from each trial's first row; empty: not in the "
               "log, or the rollout has no such stance; flight: since the liftoff before; ..._of_others: mean of the "
               "other stances of the logs; ..._band: half of the 95 % band of the constants' errors. Units: s."));
  for (const StanceErrors& e : contacts.errors)
    for (const auto& [what, of] : {std::pair("stance", e.duration), {"flight", e.flight}})
      if (of.others <= of.relative)
        run.warn(fmt::format(
            "{}: the mean of the other landings is nearer to the {} than the robot: {:.3g} against {:.3g} %",
            contacts.names[std::size_t(e.contact)], what, 100 * of.others, 100 * of.relative));
}

Quantities<TriedLaw> law_quantities() {
  return {
      {"", "law", "law", {}, [](auto& t) { return words(t.law); }},
      {"", "converged", &TriedLaw::converged},
      {"", "rms", "residual rms, in the logs' noise", "{:.4g}", [](auto& t) { return number(t.rms); }},
      {"", "fitted", "numbers fitted", "{}", &TriedLaw::fitted},
      {"", "bic", "BIC, less that of the scene's law", "{:.1f}", [](auto& t) { return number(t.bic); }},
      {"", "held_out", "rms of drops left out", "{:.4g}", [](auto& t) { return number(t.held_out); }},
      {"", "rejected", "its own residuals", {}, [](auto& t) { return t.rejected ? "reject it" : "do not reject it"; }}};
}

/// Which contact law the drops support best, and why.
std::string finding(const BodyCalibration& c) {
  const TriedLaw &given = c.laws.front(), &best = c.laws[c.best_law];
  if (c.best_law == 0)
    return fmt::format("of {} laws that were tried none is better than the scene's ({}){}", c.laws.size(),
                       words(given.law),
                       given.rejected ? "; but its residuals reject it too: the floor is none of these" : "");
  return fmt::format(
      "the drops ask for another law: {}, not {}: BIC {:.0f} lower, residuals {:.3g} in place of {:.3g} times the "
      "logs' noise{}{}; {}",
      words(best.law), words(given.law), -best.bic, best.rms, given.rms,
      std::isfinite(best.held_out)
          ? fmt::format(", of drops left out {:.3g} in place of {:.3g}", best.held_out, given.held_out)
          : ", and no drop could be left out to test it",
      best.rejected ? "; its own residuals reject it too" : "",
      c.scene_law == c.best_law ? "the constants and scene.toml are of that law" : "--law asked fits and writes it");
}

/// Reports the tried laws: table, JSON, finding.
void report_laws(const BodyCalibration& c, Report& report, Json& summary, Run& run) {
  if (c.laws.empty()) return;
  const Table laws(law_quantities(), c.laws);
  summary["laws"] = laws.objects();
  summary["law"] = {{"given", words(c.laws.front().law)}, {"asked", words(c.laws[c.best_law].law)}};
  summary["law_rejected"] = c.law_rejected();
  if (c.laws.size() < 2) return;
  report.heading("Which law do the drops ask for?");
  report.table(laws);
  const std::string text = finding(c);
  report.paragraph(text + ".");
  if (c.best_law == c.scene_law)
    run.say(text);
  else
    run.warn(text);
}

/// Of drops and their calibration.
template <class Drops>
FitTexts texts_of(const Drops& c) {
  FitTexts out{c.result, {}};
  for (const auto& d : c.drops) out.logs.push_back(&d.log);
  return out;
}

}  // namespace

int report_prediction(const FitTexts& played, const ContactTimes& contacts, Run& run) {
  const FloorFit& c = played.result;
  for (const std::string& w : c.warnings) run.warn(w);
  const bool followed = std::all_of(c.drops.begin(), c.drops.end(), [](const DropResult& d) { return d.simulated; });
  if (!c.converged) run.warn((followed ? "a start did not converge: " : "not followed: ") + c.message);
  Report report("Prediction");
  Json summary;
  summary["nuisance"] = nuisance_json(c.nuisance);
  summary["converged"] = c.converged;
  report.heading(fmt::format("The {}, for given constants", words(c.logs_of).many));
  report_drops(played, words(c.logs_of).one, report, summary, run);
  const Check nearer = report_baselines(played, report, summary, run);
  if (!contacts.names.empty()) {
    report.heading("When its contacts touch");
    summary["contacts"] =
        add_table(Table(stance_quantities(c, contacts.names), simulated_stances(c)), report, run, "contacts.csv",
                  "Of the simulation; t from each trial's first row; flight: since the contact's liftoff before; "
                  "..._band: half of the 95 % band of the constants' errors. Units: s.");
  }
  report_landings(played, contacts, report, summary, run);
  run.add("fit.csv", samples_csv(run, played));
  FirstScreen screen;
  screen.sentence = fmt::format("{} {} followed with given constants.", c.drops.size(), words(c.logs_of).many);
  screen.checks.push_back(check(c.converged, "followed to the end", c.converged ? "" : c.message));
  screen.checks.push_back(nearer);
  if (!c.bands.empty()) screen.checks.push_back(check_promises(played, run));
  report.answer(screen, run.warnings());
  report.write(run);
  return run.finish(summary, c.converged ? kDone : kNumbers);
}

int report(const CalibratedDrops& fitted, const std::optional<CalibratedDrops>& validation, Doubt doubt, Run& run) {
  return report(texts_of(fitted), validation ? std::optional(texts_of(*validation)) : std::nullopt, doubt,
                {{"scene.toml", to_toml(fitted.result.scene, scene_comments(run, fitted.result))}}, {}, run);
}

int report(const std::string& path, const BodyCalibratedDrops& fitted,
           const std::optional<BodyCalibratedDrops>& validation, Doubt doubt, Run& run) {
  const BodyCalibration& c = fitted.result;
  BodyScene scene = c.scene;
  scene.source = "calibrated from drop logs by ukemi";
  return report(
      texts_of(fitted), validation ? std::optional(texts_of(*validation)) : std::nullopt, doubt,
      path.empty() ? std::map<std::string, std::string>{}
                   : scene_files(path, scene, scene_comments(run, c), run.folder()),
      [&](Report& page, Json& summary) { report_laws(c, page, summary, run); }, run);
}

}  // namespace ukemi::tools

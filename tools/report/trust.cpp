#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "common/actuator.hpp"
#include "tools/program/arguments.hpp"
#include "tools/report/identify.hpp"

namespace ukemi::tools {

using identify::Fit;
using identify::kTestLevel;
using identify::LeftOut;
using identify::Trust;

namespace {

/// The constant whose value moves most when the trial is left out.
std::size_t most_moved(const LeftOut& l) {
  std::size_t largest = 0;
  for (std::size_t k = 1; k < l.shift.size(); ++k)
    if (!(std::abs(l.shift[k]) <= std::abs(l.shift[largest])) && std::isfinite(l.shift[k])) largest = k;
  return largest;
}

std::string interval(const identify::Profile& p) {
  const auto end = [](const std::optional<double>& x) { return x ? fmt::format("{:.6g}", *x) : "beyond the grid"; };
  return fmt::format("{} .. {} {}", end(p.low), end(p.high), p.unit);
}

/// Terms that would explain the residuals as well as `term`; empty where there are none.
std::string rivals_words(const Trust& t, const std::string& term) {
  std::vector<std::string> others, all{term};
  for (const identify::Rival& r : t.rivals)
    if (r.term == term) others.push_back(fmt::format("{} of {:.4g}", r.other, r.value)), all.push_back(r.other);
  if (others.empty()) return "";
  return fmt::format("{} would explain the residuals as well as {}; to tell them apart: {}", fmt::join(others, ", or "),
                     term, experiments(all));
}

std::string weakest_words(const Fit& fit) { return in_words(*fit.weakest, "trials", "the angles", "rad"); }

/// Findings of the tests, a sentence each.
std::vector<std::string> findings(const Trust& t, const Fit& fit) {
  std::vector<std::string> out;
  const identify::ResidualTests& tests = t.tests;
  if (const identify::ScoreTest* missed = tests.missing()) {
    const std::string term = missed->term;
    // With flawed logs another term would only hide the flaw.
    const std::string advice = fit.flawed_logs ? "" : ": try --nuisance " + term;
    out.push_back(fmt::format(
        "the model lacks {} (score test, p {}): of all terms it explains most of the residuals, their rms "
        "would fall from {:.4g} to {:.4g} rad{}",
        term, probability_words(missed->p), std::sqrt(tests.score->variance), tests.rms_with(*missed), advice));
    if (const std::string words = rivals_words(t, term); !words.empty()) out.push_back(words);
  }
  for (const identify::Estimate& e : fit.nuisance)
    if (const std::string words = e.trial < 0 ? rivals_words(t, e.name) : ""; !words.empty())
      out.push_back(words + "; no constant is trusted that would then leave its interval");
  if (tests.whiteness.rejected) out.push_back(not_white_words(tests));
  if (tests.model_rejected()) out.push_back(rejected_words(tests, "model", "logs"));
  if (tests.normality.rejected)
    out.push_back(
        fmt::format("the residuals are not normal (Jarque-Bera, p {}; skewness {:.2f}, excess kurtosis {:.2f}){}",
                    probability_words(tests.normality.p), tests.normality.skewness, tests.normality.kurtosis,
                    tests.normality.kurtosis > 1 ? ": outliers? see --loss huber:DELTA" : ""));
  if (t.ladder && t.ladder->plain_rejected()) {
    const identify::Ladder& l = *t.ladder;
    out.push_back(fmt::format(
        "the model without further terms is rejected (likelihood ratio, level {:g} %: p {}); BIC prefers {}",
        100 * kTestLevel, probability_words(l.p_plain), l.rungs[l.preferred].name));
  }
  for (const LeftOut& l : t.left_out)
    if (l.disagrees)
      out.push_back(fmt::format(
          "{} disagrees with the other trials (Chow's test, level {:g} % for all: p {}): without it {} "
          "moves by {:+.1f} standard errors",
          l.file, 100 * kTestLevel, probability_words(l.p), kConstantNames[most_moved(l)], l.shift[most_moved(l)]));
  return out;
}

/// Columns of the score test of a term that the model may lack.
Quantities<identify::ScoreTest> score_quantities(const identify::ResidualTests& tests, const std::string& unit) {
  using Test = identify::ScoreTest;
  const auto of_shared = [](double Test::*value, double factor = 1) {
    return [=](const Test& t) { return t.scope == identify::Scope::kShared ? Json(factor * t.*value) : Json(); };
  };
  return {
      {"", "term", &Test::term},
      {"", "", "hypothesis", {}, [](auto& t) { return fmt::format("no {} (score test)", t.term); }},
      {"", "p", "p", probability_words, &Test::p},
      {"", "chi2", &Test::statistic},
      {"", "degrees", &Test::degrees},
      {"", "z", of_shared(&Test::z)},
      {"", "size", &Test::size},
      {"", "rejected", "rejected", {}, &Test::rejected},
      {"", "missed", [&](auto& t) { return &t == tests.missing(); }},
      {"", "rms_with", "rms with the term [" + unit + "]", "{:.4g}", [&](auto& t) { return tests.rms_with(t); }},
      {"", "bias", of_shared(&Test::bias)},
      // Below 3 of its own standard errors a term escapes its test more often than not.
      {"", "", "bias that may hide [standard errors]", "{:.2g}", of_shared(&Test::bias, 3)},
  };
}

const Quantities<identify::Rival> rival_quantities = {
    {"", "term", &identify::Rival::term},
    {"", "other", &identify::Rival::other},
    {"", "value", &identify::Rival::value},
    {"", "bic", &identify::Rival::bic},
};

Quantities<identify::Rung> rung_quantities(const identify::Ladder& ladder) {
  return {
      {"", "name", "model", {}, &identify::Rung::name},
      {"", "", "preferred", {}, [&](auto& r) { return &r == &ladder.rungs[ladder.preferred]; }},
      {"", "converged", [](auto& r) { return r.fit.converged; }},
      {"", "terms",
       [](auto& r) {
         Json terms = Json::object();
         for (const identify::RigTerm& term : *r.options.terms.table)
           if (term.in_ladder && term.value_in(r.fit.sea) != 0) terms[term.name] = number(term.value_in(r.fit.sea));
         return terms;
       }},
      {"", "bic", "BIC", "{:.1f}", &identify::Rung::bic},
      {"", "p", "p of plain against it", probability_words, &identify::Rung::p},
      {"", "rms", "rms [rad]", "{:.4g}", [](auto& r) { return r.fit.rms; }},
      {"", "held_out_rms", "held-out rms [rad]", "{:.4g}", &identify::Rung::held_out},
  };
}

Quantities<LeftOut> left_out_quantities() {
  Quantities<LeftOut> out = {{"", "file", "left out", {}, &LeftOut::file}};
  for (std::size_t k = 0; k < kConstants; ++k)
    out.push_back({"", std::string("shift/") + kConstantNames[k], kConstantNames[k], "{:+.2f}",
                   [k](auto& l) { return number(l.shift[k]); }});
  out.push_back({"", "held_out_rms", "held-out rms [rad]", "{:.4g}", &LeftOut::held_out});
  out.push_back({"", "p", "p", probability_words, &LeftOut::p});
  out.push_back({"", "disagrees", "disagrees", {}, &LeftOut::disagrees});
  return out;
}

/// Residual rms of each rung, of its fit and of held-out trials.
Figure ladder_figure(const identify::Ladder& ladder) {
  Figure out;
  Panel p;
  Series fitted{"residual of the fit", {}, {}, Series::Style::kPoints, 0},
      held_out{"of trials held out", {}, {}, Series::Style::kPoints, 1};
  const std::size_t n = ladder.rungs.size();
  for (std::size_t i = 0; i < n; ++i) {
    const identify::Rung& r = ladder.rungs[i];
    p.rows.push_back(r.name + (i == ladder.preferred ? " (BIC)" : ""));
    for (auto& [series, rms] : {std::pair(&fitted, r.fit.rms), {&held_out, r.held_out}})
      if (std::isfinite(rms)) series->x.push_back(1e3 * rms), series->y.push_back(double(n - i));
  }
  p.x_label = "rms [mrad]", p.series = {fitted, held_out};
  out.name = "ladder", out.panels = {p}, out.panel_height = 90 + 26.0 * double(n);
  out.caption = "What each model leaves: a term that the trials ask for moves both to the left.";
  return out;
}

void report_ladder(const identify::Ladder& ladder, Report& report, Json& j, Run& run) {
  report.heading("Model ladder");
  j["ladder"] = {{"preferred", ladder.rungs[ladder.preferred].name},
                 {"plain_p", number(ladder.p_plain)},
                 {"plain_rejected", ladder.plain_rejected()},
                 {"rungs", add_table(Table(rung_quantities(ladder), ladder.rungs), report, run)}};
  report.figure(ladder_figure(ladder));
}

void report_left_out(const std::vector<LeftOut>& left_out, Report& report, Json& j, Run& run) {
  report.heading("Without each trial");
  report.paragraph(
      "Shifts in standard errors of the whole fit; p of Chow's test that the trial agrees with the others.");
  j["leave_one_out"] = add_table(Table(left_out_quantities(), left_out), report, run);
}

/// The weakest direction: joint change of the constants that the trials determine least.
Figure weakest_figure(const identify::Weakest& w) {
  Panel p;
  p.x_label = "change of the constant [%]";
  Series bars{"", {}, {}, Series::Style::kBars, 5};
  for (const auto& [name, relative] : w.change) {
    p.rows.push_back(name);
    bars.x.push_back(100 * relative), bars.y.push_back(double(w.change.size() - bars.y.size()));
  }
  p.series = {bars};
  Figure out{.name = "weakest", .panels = {p}, .panel_height = 80 + 26.0 * double(p.rows.size())};
  out.caption = fmt::format(
      "The weakest direction: what the trials know least. All of these changes together move the angles by {:.2g} rad "
      "(rms) where the noise is {:.2g} rad.",
      w.rms, w.noise);
  return out;
}

}  // namespace

std::string probability_words(double p) { return p < 1e-16 ? "below 1e-16" : fmt::format("{:.2g}", p); }

std::string not_white_words(const identify::ResidualTests& tests) {
  return fmt::format("the residuals are not white (Ljung-Box, p {}; neighbours correlate by {:.2f})",
                     probability_words(tests.whiteness.p), tests.whiteness.correlation);
}
std::string rejected_words(const identify::ResidualTests& tests, const std::string& model, const std::string& logs) {
  return fmt::format(
      "the {} does not explain these {}: no constant is trusted, and the errors {} (tests at {:g} % together); the "
      "true ones may be larger still",
      model, logs,
      tests.score ? "are widened to what the residuals say"
                  : "are those of white residuals, for not every term's derivative could be followed",
      100 * kTestLevel);
}

void report_tests(const identify::ResidualTests& tests, const std::string& unit, Report& report, Json& j) {
  const Table missing(score_quantities(tests, unit), tests.score_tests);
  j["level"] = kTestLevel;
  j["model_rejected"] = tests.model_rejected();
  j["whiteness"] = {{"p", number(tests.whiteness.p)},
                    {"lags", identify::kWhitenessLags},
                    {"correlation", number(tests.whiteness.correlation)},
                    {"rejected", tests.whiteness.rejected}};
  j["normality"] = {{"p", number(tests.normality.p)},
                    {"skewness", number(tests.normality.skewness)},
                    {"kurtosis", number(tests.normality.kurtosis)},
                    {"rejected", tests.normality.rejected},
                    {"coarse_logs_left_out", tests.normality.coarse}};
  j["missing_terms"] = missing.objects();
  const auto result = [](bool rejected) { return rejected ? "rejected" : "not rejected"; };
  report.table(
      {"hypothesis", "p", ""},
      {{"residuals are white (Ljung-Box)", probability_words(tests.whiteness.p), result(tests.whiteness.rejected)},
       {tests.normality.tested > 0 ? "residuals are normal (Jarque-Bera)"
                                   : "residuals are normal: not tested, the logs are coarsely quantised",
        probability_words(tests.normality.p), result(tests.normality.rejected)}});
  report.table(missing);
  if (!tests.chow.empty()) j["chow"] = tests.chow;
}

void report_profiles(const std::vector<identify::Profile>& profiles, const identify::Estimates& fit, Report& report,
                     Json& j, Run& run) {
  if (profiles.empty()) return;
  CsvWriter csv = run.csv();
  csv.comment(
      "rise of -2 log likelihood above its minimum, the other constants refitted; empty where no rollout is possible. "
      "Inside the 95 % interval it is below `threshold`.");
  csv.header({"constant", "value", "rise", "threshold"});
  for (const identify::Profile& p : profiles) {
    const identify::Estimate& e = *find_constant(fit, p.constant);
    j["profile"][p.constant] = {{"ci95", {number(p.low), number(p.high)}},
                                {"ci95_noise", {number(p.low_noise), number(p.high_noise)}},
                                {"linear", {e.ci_low, e.ci_high}}};
    run.say(fmt::format("{} by profile likelihood, 95 %: {}", p.constant, interval(p)));
    report.heading("Profile likelihood of " + p.constant);
    report.paragraph("95 %: " + interval(p));
    report.plot(
        fmt::format("profile_{}", &p - profiles.data() + 1), fmt::format("{} [{}]", p.constant, p.unit),
        "rise of -2 log likelihood",
        {{"refitted", p.value, p.rise}, {"95 %", {p.value.front(), p.value.back()}, {p.threshold, p.threshold}}});
    for (std::size_t i = 0; i < p.value.size(); ++i)
      csv.cell(p.constant)
          .cell(p.value[i])
          .cell(std::isfinite(p.rise[i]) ? p.rise[i] : NAN)
          .cell(p.threshold)
          .end_row();
  }
  run.add("profile.csv", csv.text());
}

void warn(const Trust& trust, const Fit& fit, Run& run) {
  for (const std::string& constant : trust.not_profiled) run.warn(constant + " has no standard error: no profile");
  for (const std::string& finding : findings(trust, fit)) run.warn(finding);
}

void report_part(const Trust& t, const Fit& fit, Report& report, Json& summary, Run& run) {
  report.heading("How far to trust it");
  report.paragraph(fmt::format(
      "Verdicts: trusted, the 95 % interval is within {:g} % of the value either way; weak, within {:g} %, or the "
      "residual is {:g} times the logs' noise or more, or the model is rejected; else not identifiable, or at its "
      "bound. Of good experiments, {:g} % fail one of the tests below (Holm). Where the residuals are not white, or a "
      "score test finds a missing term, the model is rejected, and the errors are a sandwich estimate. A term of less "
      "than 3 of its own standard errors escapes its test more often than not; the last column says how far the most "
      "affected constant is then off.",
      100 * identify::kTrustedWidth, 100 * identify::kWeakWidth, identify::kFarAboveNoise, 100 * kTestLevel));
  summary["weakest"] = nullptr;
  if (fit.weakest) {
    run.say(weakest_words(fit));
    report.paragraph("Weakest direction: " + weakest_words(fit) + ".");
    report.figure(weakest_figure(*fit.weakest));
    summary["weakest"] = {
        {"text", weakest_words(fit)}, {"rms", number(fit.weakest->rms)}, {"noise", number(fit.weakest->noise)}};
    for (const auto& [name, relative] : fit.weakest->change)
      summary["weakest"]["relative_change"][name] = number(relative);
  }
  Json& j = summary["diagnostics"];
  report_tests(t.tests, "rad", report, j);
  j["rivals"] = Table(rival_quantities, t.rivals).objects();
  if (t.ladder) report_ladder(*t.ladder, report, j, run);
  if (!t.left_out.empty()) report_left_out(t.left_out, report, j, run);
  report_profiles(t.profiles, fit, report, j, run);
}

}  // namespace ukemi::tools

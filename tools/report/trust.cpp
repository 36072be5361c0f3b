#include "tools/report/trust.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "tools/program/arguments.hpp"
#include "tools/verbs/verbs.hpp"

namespace ukemi::tools {

using identify::kTestLevel;

/// Of a term's standard errors: smaller ones escape the score tests more often than not.
constexpr double kHidden = 3;

void add_trust_options(CLI::App& verb, TrustArguments& arguments) {
  verb.add_flag_callback(
      "--strict", [&] { arguments.doubt = TrustArguments::Doubt::kFail; },
      "exit 1 unless every fitted constant is trusted (95 % interval within 10 % of its value)");
  verb.add_flag_callback(
      "--diagnose", [&] { arguments.depth = TrustArguments::Depth::kRefit; },
      "refit with and without each optional term (BIC, likelihood ratio, held-out error), and without each trial");
  verb.add_option("--profile", arguments.profile,
                  "k_sea,...: profile likelihood of these constants: profile.csv and unsymmetric 95 % intervals");
}

namespace {

/// The constant whose value moves most when the trial is left out.
std::size_t most_moved(const identify::LeftOut& l) {
  std::size_t most = 0;
  for (std::size_t k = 1; k < l.shift.size(); ++k)
    if (!(std::abs(l.shift[k]) <= std::abs(l.shift[most])) && std::isfinite(l.shift[k])) most = k;
  return most;
}

std::string small(double p) { return p < 1e-16 ? "below 1e-16" : fmt::format("{:.2g}", p); }

std::string interval(const std::optional<double>& low, const std::optional<double>& high) {
  return fmt::format("{} .. {}", low ? fmt::format("{:.6g}", *low) : "beyond the grid",
                     high ? fmt::format("{:.6g}", *high) : "beyond the grid");
}

/// What the tests say, a sentence each.
std::vector<std::string> findings(const Trust& t, const identify::Fit& fit) {
  std::vector<std::string> out;
  const identify::ResidualTests& tests = t.tests;
  if (const identify::Lack* missed = tests.missed()) {
    const std::string term = name(missed->term);
    // Where the logs themselves are at fault a term would only cover it up.
    const std::string advice = fit.flawed_logs ? "" : ": try --nuisance " + term;
    out.push_back(
        fmt::format("the residuals ask for {}, which the model lacks (score test, p {}): it would explain most, their "
                    "rms would fall "
                    "from {:.4g} to {:.4g} rad{}",
                    term, small(missed->p), std::sqrt(tests.score->variance), tests.rms_with(*missed), advice));
  }
  if (tests.whiteness.rejected)
    out.push_back(fmt::format("the residuals are not white (Ljung-Box, p {}; neighbours correlate by {:.2f})",
                              small(tests.whiteness.p), tests.whiteness.correlation));
  if (tests.model_rejected())
    out.push_back(
        fmt::format("the model does not explain these logs: no constant is trusted, and the errors are widened "
                    "to what the residuals say (tests at {:g} % together); the true ones may be larger still",
                    100 * kTestLevel));
  if (tests.model_rejected() && fit.sea.friction > 0)
    out.push_back(fmt::format("dry friction is smoothed below {} rad/s here: a joint that sticks leaves such residuals",
                              kFrictionSpeed));
  if (tests.normality.rejected)
    out.push_back(
        fmt::format("the residuals are not normal (Jarque-Bera, p {}; skewness {:.2f}, excess kurtosis {:.2f}){}",
                    small(tests.normality.p), tests.normality.skewness, tests.normality.kurtosis,
                    tests.normality.kurtosis > 1 ? ": outliers? see --loss huber:DELTA" : ""));
  if (t.ladder && t.ladder->plain_rejected()) {
    const identify::Ladder& l = *t.ladder;
    out.push_back(
        fmt::format("the model without further terms is rejected (likelihood ratio, level {:g} %: p {}); BIC "
                    "prefers {}",
                    100 * kTestLevel, small(l.p_plain), l.rungs[l.preferred].name));
  }
  for (const identify::LeftOut& l : t.left_out)
    if (l.disagrees)
      out.push_back(
          fmt::format("{} disagrees with the other trials (Chow's test, level {:g} % for all: p {}): without "
                      "it {} moves by {:+.1f} standard errors",
                      l.file, 100 * kTestLevel, small(l.p), kConstantNames[most_moved(l)], l.shift[most_moved(l)]));
  return out;
}

}  // namespace

Trust examine(const identify::Experiment& experiment, identify::Fit& fit, const TrustArguments& arguments, Run& run) {
  Trust t;
  const int threads = run.options().threads;
  t.tests = test_residuals(experiment, fit);
  heed(t.tests, fit);
  if (fit.interrupted) return t;
  if (arguments.depth == TrustArguments::Depth::kRefit) {
    t.ladder = ladder(experiment, fit, identify::HeldOut::kCompute, threads);
    if (fit.converged) t.left_out = leave_one_out(experiment, fit, threads);
  }
  for (const std::string& constant : split(arguments.profile)) {
    if (fit.parameters[constant_index("--profile", constant)].std && fit.converged)
      t.profiles.push_back(profile(experiment, fit, constant));
    else
      run.warn(constant + " has no standard error: no profile");
  }
  for (const std::string& f : findings(t, fit)) run.warn(f);
  return t;
}

Json weakest_json(const identify::Fit& fit) {
  if (!fit.weakest) return nullptr;
  Json change = Json::object();
  for (const auto& [name, relative] : fit.weakest->change) change[name] = number(relative);
  return {{"text", in_words(*fit.weakest, "trials", "the angles", "rad")},
          {"relative_change", change},
          {"rms", number(fit.weakest->rms)},
          {"noise", number(fit.weakest->noise)}};
}

Json diagnostics_json(const Trust& t, const identify::Fit& fit) {
  Json j;
  j["level"] = kTestLevel;
  const identify::ResidualTests& tests = t.tests;
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
  j["missing_terms"] = Json::array();
  for (std::size_t i = 0; i < tests.lacks.size(); ++i) {
    const identify::Lack& l = tests.lacks[i];
    j["missing_terms"].push_back({{"term", name(l.term)},
                                  {"chi2", number(l.statistic)},
                                  {"degrees", l.degrees},
                                  {"z", is_shared(l.term) ? number(l.z) : Json(nullptr)},
                                  {"p", number(l.p)},
                                  {"size", number(l.size)},
                                  {"bias", is_shared(l.term) ? number(l.bias) : Json(nullptr)},
                                  {"rms_with", number(tests.rms_with(l))},
                                  {"rejected", bool(tests.lack_rejected[i])},
                                  {"missed", &l == tests.missed()}});
  }
  if (t.ladder) {
    Json rungs = Json::array();
    for (const identify::Rung& r : t.ladder->rungs) {
      Json terms = Json::object();
      for (const identify::LadderTerm& term : identify::kLadderTerms)
        if (r.fit.sea.*term.value != 0) terms[identify::name(term.term)] = number(r.fit.sea.*term.value);
      rungs.push_back({{"name", r.name},
                       {"converged", r.fit.converged},
                       {"terms", terms},
                       {"rms", number(r.fit.rms)},
                       {"bic", number(r.bic)},
                       {"p", number(r.p)},
                       {"held_out_rms", number(r.held_out)}});
    }
    j["ladder"] = {{"preferred", t.ladder->rungs[t.ladder->preferred].name},
                   {"plain_p", number(t.ladder->p_plain)},
                   {"plain_rejected", t.ladder->plain_rejected()},
                   {"rungs", rungs}};
  }
  if (!t.left_out.empty()) {
    j["leave_one_out"] = Json::array();
    for (const identify::LeftOut& l : t.left_out) {
      Json shift = Json::object();
      for (std::size_t k = 0; k < l.shift.size(); ++k) shift[kConstantNames[k]] = number(l.shift[k]);
      j["leave_one_out"].push_back({{"file", l.file},
                                    {"shift", shift},
                                    {"held_out_rms", number(l.held_out)},
                                    {"p", number(l.p)},
                                    {"disagrees", l.disagrees}});
    }
  }
  if (!t.profiles.empty()) {
    j["profile"] = Json::object();
    for (const identify::Profile& p : t.profiles) {
      const identify::Estimate& e = fit.parameters[constant_index("--profile", p.constant)];
      j["profile"][p.constant] = {{"ci95", {number(p.low), number(p.high)}}, {"linear", {e.ci_low, e.ci_high}}};
    }
  }
  return j;
}

void say(const Trust& t, const identify::Fit& fit, const Run& run) {
  if (fit.weakest) run.say(in_words(*fit.weakest, "trials", "the angles", "rad"));
  if (t.ladder)
    for (const identify::Rung& r : t.ladder->rungs)
      run.say(fmt::format("model {:12} BIC {:.1f}, rms {:.4g} rad{}{}", r.name, r.bic, r.fit.rms,
                          std::isfinite(r.held_out) ? fmt::format(", held out {:.4g} rad", r.held_out) : "",
                          &r == &t.ladder->rungs[t.ladder->preferred] ? "  <- preferred" : ""));
  for (const identify::LeftOut& l : t.left_out)
    run.say(fmt::format("without {}: {} moves most, by {:+.2f} standard errors; held out {:.4g} rad", l.file,
                        kConstantNames[most_moved(l)], l.shift[most_moved(l)], l.held_out));
  for (const identify::Profile& p : t.profiles)
    run.say(fmt::format("{} by profile likelihood, 95 %: {} {}", p.constant, interval(p.low, p.high), p.unit));
}

void add_section(Report& report, const Trust& t, const identify::Fit& fit) {
  report.heading("How far to trust it");
  report.paragraph(fmt::format(
      "Verdicts: trusted, the 95 % interval is within {:g} % of the value either way; weak, "
      "within {:g} %, or the residual is {:g} times the logs' noise or more, or the model is rejected; else not "
      "identifiable, or at its bound. The tests below speak up together in {:g} % of good experiments (Holm); where "
      "the "
      "residuals are not white or ask for a term, the model is rejected, and the errors are a sandwich estimate. A "
      "term of less than 3 of its own standard errors hides from its test more often "
      "than not; the last column says how far the most affected constant is off by then.",
      100 * identify::kTrustedWidth, 100 * identify::kWeakWidth, identify::kFarAboveNoise, 100 * kTestLevel));
  if (fit.weakest)
    report.paragraph("Weakest direction: " + in_words(*fit.weakest, "trials", "the angles", "rad") + ".");
  const auto result = [](bool rejected) { return rejected ? "rejected" : "not rejected"; };
  std::vector<std::vector<std::string>> rows;
  const identify::ResidualTests& tests = t.tests;
  rows.push_back(
      {"residuals are white (Ljung-Box)", small(tests.whiteness.p), result(tests.whiteness.rejected), "", ""});
  rows.push_back({tests.normality.tested > 0 ? "residuals are normal (Jarque-Bera)"
                                             : "residuals are normal: not tested, the logs are coarsely quantised",
                  small(tests.normality.p), result(tests.normality.rejected), "", ""});
  for (std::size_t i = 0; i < tests.lacks.size(); ++i) {
    const identify::Lack& l = tests.lacks[i];
    rows.push_back({fmt::format("no {} (score test)", name(l.term)), small(l.p), result(tests.lack_rejected[i]),
                    fmt::format("{:.4g}", tests.rms_with(l)),
                    is_shared(l.term) ? fmt::format("{:.2g}", kHidden * l.bias) : ""});
  }
  report.table({"hypothesis", "p", "", "rms with the term [rad]", "bias that may hide [standard errors]"}, rows);
  if (t.ladder) {
    report.heading("Model ladder");
    rows.clear();
    for (const identify::Rung& r : t.ladder->rungs)
      rows.push_back({r.name + (&r == &t.ladder->rungs[t.ladder->preferred] ? " (preferred)" : ""),
                      fmt::format("{:.1f}", r.bic), r.terms ? small(r.p) : "", fmt::format("{:.4g}", r.fit.rms),
                      std::isfinite(r.held_out) ? fmt::format("{:.4g}", r.held_out) : ""});
    report.table({"model", "BIC", "p of plain against it", "rms [rad]", "held-out rms [rad]"}, rows);
  }
  if (!t.left_out.empty()) {
    report.heading("Without each trial");
    report.paragraph(
        "Shifts in standard errors of the whole fit; p of Chow's test that the trial agrees with the others.");
    rows.clear();
    for (const identify::LeftOut& l : t.left_out) {
      rows.push_back({l.file});
      for (const double s : l.shift) rows.back().push_back(std::isfinite(s) ? fmt::format("{:+.2f}", s) : "");
      rows.back().push_back(fmt::format("{:.4g}", l.held_out));
      rows.back().push_back(small(l.p) + (l.disagrees ? " (disagrees)" : ""));
    }
    std::vector<std::string> header = {"left out"};
    header.insert(header.end(), kConstantNames.begin(), kConstantNames.end());
    header.insert(header.end(), {"held-out rms [rad]", "p"});
    report.table(header, rows);
  }
  for (const identify::Profile& p : t.profiles) {
    report.heading("Profile likelihood of " + p.constant);
    report.paragraph(fmt::format("95 %: {} {}", interval(p.low, p.high), p.unit));
    report.plot(
        fmt::format("{} [{}]", p.constant, p.unit), "rise of -2 log likelihood",
        {{"refitted", p.value, p.rise}, {"95 %", {p.value.front(), p.value.back()}, {p.threshold, p.threshold}}});
  }
}

std::string profile_csv(const Trust& t, const Run& run) {
  CsvWriter csv = run.csv();
  csv.comment(
      "rise of -2 log likelihood above its minimum, the other constants refitted; empty where no rollout is "
      "possible. Inside the 95 % interval it is below `threshold`.");
  csv.header({"constant", "value", "rise", "threshold"});
  for (const identify::Profile& p : t.profiles)
    for (std::size_t i = 0; i < p.value.size(); ++i)
      csv.cell(p.constant)
          .cell(p.value[i])
          .cell(std::isfinite(p.rise[i]) ? p.rise[i] : std::nan(""))
          .cell(p.threshold)
          .end_row();
  return csv.text();
}

}  // namespace ukemi::tools

#include <fmt/format.h>

#include <cmath>

#include "tools/report/compare.hpp"
#include "tools/report/fall.hpp"
#include "tools/report/landing.hpp"
#include "tools/report/landing_doubts.hpp"
#include "tools/report/results.hpp"
#include "tools/report/scatter.hpp"
#include "tools/study/comparison.hpp"

namespace ukemi::tools {

const Outputs kCompareOutputs =
    Outputs{"compare", {"parameters.csv", "trajectories.csv"}, {"constants"}}.with(fall_figures());

using namespace landing;

namespace {

std::string signed_percent(double percent) { return fmt::format("{:+.1f} %", percent); }

Json inside(const ConstantDifference& c) { return c.inside() ? Json(*c.inside()) : Json(); }

const Quantities<ConstantDifference> kConstantQuantities = {
    {"parameter", "", "constant", {}, &ConstantDifference::name},
    {"unit", "", &ConstantDifference::unit},
    {"nominal", "nominal", "nominal", "{:.5g}", [](auto& c) { return c.value[0]; }},
    {"identified", "identified", "identified", "{:.5g}", [](auto& c) { return c.value[1]; }},
    {"difference", &ConstantDifference::difference},
    {"difference_percent", "difference_percent", "difference", signed_percent,
     [](auto& c) { return number(c.percent()); }},
    {"std", [](auto& c) { return number(c.std); }},
    {"z", "z", "in standard errors", "{:+.1f}", [](auto& c) { return number(c.z()); }},
    {"inside_ci95", "inside_ci95", "nominal inside the 95 % interval", {}, inside},
};

/// Columns of a trial: rms of its residual with each set.
Quantities<identify::Trial> residual_quantities(const Comparison& c) {
  const auto rms = [&c](std::size_t set) {
    return [&c, set](const identify::Trial& trial) {
      const auto m = std::size_t(&trial - c.measured->trials.data());
      const identify::TrialResult& t = (*c.predictions)[set].trials[m];
      return t.status == identify::RolloutStatus::kDone ? t.rms : NAN;
    };
  };
  return {
      {"", "file", "trial", {}, &identify::Trial::file},
      {"", "nominal", "nominal [rad]", "{:.4g}", rms(0)},
      {"", "identified", "identified [rad]", "{:.4g}", rms(1)},
  };
}

Quantities<MotionTexts> peak_quantities(bool rated) {
  const auto heading = [rated](const char* set) {
    return fmt::format("{} with {} [{}]", goal_name(rated), set, goal_unit(rated));
  };
  return {
      {"", "", "motion", {}, [](auto& m) { return fmt::format("best for {}: {}", m.set, m.words); }},
      {"", "nominal", heading("nominal"), "{:.5g}", [](auto& m) { return m.peaks[0]; }},
      {"", "identified", heading("identified"), "{:.5g}", [](auto& m) { return m.peaks[1]; }},
  };
}

/// Columns of plans for scatter: promised value, and peaks with the identified constants as the truth.
Quantities<PlanTexts> plan_quantities(bool rated) {
  Quantities<PlanTexts> out = {
      {"", "set", "planned with", {}, &PlanTexts::set},
      {"", "", "motion", {}, &PlanTexts::words},
      {"", "promised", fmt::format("promised [{}]", goal_unit(rated)), short_peak_words, &PlanTexts::promised}};
  append(out, "truth/", distribution_quantities(), &PlanTexts::truth);
  return out;
}

void warn(const Comparison& c, Run& run) {
  for (std::size_t s = 0; s < 2 && c.predictions; ++s)
    if (const identify::Fit& fit = (*c.predictions)[s]; !fit.converged)
      run.warn(std::string(kSets[s]) + ": " + fit.message);
  const auto doubts = [](std::size_t, const Motion&, const Landing& l) { return landing_doubts(l); };
  warn_of_motions(c.motions, "point", doubts, run);
}

/// How much worse the plan of the nominal constants is on the identified actuator.
FirstScreen conclusion(const ComparisonTexts& c) {
  const double best = c.motions[1].peaks[1], nominal = c.motions[0].peaks[1], promised = c.motions[0].peaks[0];
  const char* verb = c.rated ? "has" : "hits with";
  return {fmt::format("Planned with the nominal constants, {} {} {} where {:.4g} was promised: {:.2f} times the {} of "
                      "the motion planned with its own constants.",
                      c.truth, verb, goal_text(nominal, c.rated), promised, nominal / best, goal_text(best, c.rated)),
          {check(nominal <= kWorse * promised, "the nominal plan keeps its promise",
                 fmt::format("promised {}, {} {:.4g}", goal_text(promised, c.rated), verb, nominal)),
           check(nominal <= kWorse * best, "the nominal constants are good enough",
                 fmt::format("{:.2f} times the {} of the own plan", nominal / best, goal_name(c.rated)))},
          "`ukemi optimize` with the identified actuator plans the landing."};
}

std::string trajectories_csv(const Comparison& c, const Run& run) {
  CsvWriter csv = run.csv();
  csv.comment("Each set's best motion under its own actuator. t = 0 at release. Units: s, m/s^2, rad.");
  csv.header({"set", "t", "acc", "phi_1", "phi_ref"});
  for (std::size_t s = 0; s < 2; ++s)
    for (const Sample& x : c.motions[s].landings[s]->trajectory)
      csv.cell(kSets[s]).cell(x.t).cell(x.acc).cell(x.phi1).cell(x.phi_ref).end_row();
  return csv.text();
}

ComparisonTexts texts_of(const Comparison& c) {
  ComparisonTexts out{.scene = c.scene ? c.scene->name : "",
                      .source = c.scene ? c.scene->floor_source : "",
                      .peak = "|ddr_0|",
                      .truth = "the identified actuator",
                      .motions = motion_texts(
                          c.motions, [](const Motion& m) { return motion_words(m); }, motion_json,
                          [](std::size_t, const Landing& l) { return l.peak; }),
                      .landed = c.landed()};
  for (std::size_t m = 0; m < out.motions.size(); ++m) {
    const TolerantPeak& tolerant = c.motions[m].best.tolerant;
    out.motions[m].tolerant_peak = tolerant.complete ? number(tolerant.value) : Json();
  }
  for (const ComparedPlan& p : c.plans)
    out.plans.push_back({p.set, motion_words(p.best.motion), p.best.value, p.truth.planned});
  return out;
}

}  // namespace

Report comparison_page(const PerSet<std::string>& names, const Run& run) {
  Report report("Identified against nominal");
  report.paragraph("nominal: " + names[0] + "; identified: " + names[1]);
  report.distrust(run.warnings());
  return report;
}

void report_constants(const std::vector<ConstantDifference>& rows, Json& summary, Report& report, Run& run) {
  const Table constants(kConstantQuantities, rows);
  summary["parameters"] = constants.keyed();
  report.heading("Constants");
  (void)add_table(constants, report, run, "parameters.csv",
                  "z: difference in standard errors of the identified constant; inside_ci95: the nominal value inside "
                  "its 95 % interval.");
}

void warn_of_short_search(const ComparisonTexts& c, Run& run) {
  constexpr double kSame = 1e-4;  // relative
  if (!c.landed) return;
  for (std::size_t s = 0; s < 2; ++s) {
    const double own = c.motions[s].peaks[s], other = c.motions[1 - s].peaks[s];
    if (other < (1 - kSame) * own)
      run.warn(
          fmt::format("the motion planned with the {} constants is better with the {} ones than their own: {:.4g}, "
                      "not {}; more --evaluations find better motions",
                      kSets[1 - s], kSets[s], other, goal_text(own, c.rated)));
  }
}

void report_motions(const ComparisonTexts& c, Json& summary, Report& report, Run& run) {
  for (const MotionTexts& m : c.motions) {
    summary["motions"][m.set] = m.numbers;
    if (m.tolerant_peak) summary["tolerant_peaks"][m.set] = *m.tolerant_peak;
  }
  if (!c.plans.empty()) {
    const Table plans(plan_quantities(c.rated), c.plans);
    summary["plans"] = plans.objects();
    report.heading("Plans for scattered drops, where the identified constants are the truth");
    (void)add_table(plans, report, run);
  }
  if (!c.landed) return;
  const Table peaks(peak_quantities(c.rated), c.motions);
  for (std::size_t m = 0; m < 2; ++m) summary["peaks"][c.motions[m].set + "_motion"] = peaks.object(m);
  report.heading((c.rated ? "Largest load" : "Peak " + c.peak) + " on " + c.scene);
  floor_source(report, c.source);
  (void)add_table(peaks, report, run);
  const FirstScreen screen = conclusion(c);
  run.say(screen.sentence);
  report.answer(screen, run.warnings());
}

int report(const Comparison& c, Json summary, Run& run) {
  warn(c, run);
  const ComparisonTexts texts = texts_of(c);
  warn_of_short_search(texts, run);
  Report report = comparison_page({c.sets[0].name, c.sets[1].name}, run);
  report_constants(c.constants, summary, report, run);
  if (c.predictions) {
    const Table rows(residual_quantities(c), c.measured->trials);
    summary["residuals"] = rows.objects();
    run.say(fmt::format("residual rms over {} trials: nominal {:.4g} rad, identified {:.4g} rad",
                        c.measured->trials.size(), (*c.predictions)[0].rms, (*c.predictions)[1].rms));
    report.heading("Residuals on the trials, rms");
    report.table(rows);
  }
  report_motions(texts, summary, report, run);
  if (c.landed()) {
    run.add("trajectories.csv", trajectories_csv(c, run));
    show({*c.scene,
          c.sets[1],
          {{"planned with the identified constants", &*c.motions[1].landings[1]},
           {"planned with the nominal constants", &*c.motions[0].landings[1]}},
          {},
          "trajectories.csv holds each motion under its own actuator"},
         report);
    report.paragraph("Both falls above are on the identified actuator, the one that stands for the real one.");
  }
  report.write(run);
  return run.finish(summary, c.complete ? kDone : kNumbers);
}

}  // namespace ukemi::tools

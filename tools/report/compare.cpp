#include <fmt/format.h>

#include <cmath>

#include "tools/report/fall.hpp"
#include "tools/report/landing.hpp"
#include "tools/report/results.hpp"
#include "tools/report/scatter.hpp"
#include "tools/study/comparison.hpp"

namespace ukemi::tools {

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
    {"difference_percent", "difference_percent", "difference", signed_percent, &ConstantDifference::percent},
    {"std", [](auto& c) { return number(c.std); }},
    {"z", "z", "in standard errors", "{:+.1f}", [](auto& c) { return number(c.z()); }},
    {"inside_ci95", "inside_ci95", "nominal inside the 95 % interval", {}, inside},
};

/// A trial, and how each set predicts it.
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

const Quantities<ComparedMotion> kPeakQuantities = {
    {"", "", "motion", {}, [](auto& m) { return fmt::format("best for {}: {}", m.set, motion_words(m.best.motion)); }},
    {"", "nominal", "peak with nominal [m/s^2]", "{:.5g}", [](auto& m) { return m.landings[0]->peak; }},
    {"", "identified", "peak with identified [m/s^2]", "{:.5g}", [](auto& m) { return m.landings[1]->peak; }},
};

/// Plans for scatter, where the identified constants are the truth.
Quantities<ComparedPlan> plan_quantities() {
  Quantities<ComparedPlan> out = {
      {"", "set", "planned with", {}, &ComparedPlan::set},
      {"", "", "motion", {}, [](auto& p) { return motion_words(p.best.motion); }},
      {"", "promised", "promised [m/s^2]", short_peak_words, [](auto& p) { return p.best.value; }}};
  append(out, "truth/", distribution_quantities(), [](auto& p) { return p.truth.planned; });
  return out;
}

void warn(const Comparison& c, Run& run) {
  for (std::size_t s = 0; s < 2 && c.predictions; ++s)
    if (const identify::Fit& fit = (*c.predictions)[s]; !fit.converged)
      run.warn(std::string(kSets[s]) + ": " + fit.message);
  for (const ComparedMotion& m : c.motions)
    if (!m.best.message.empty()) run.warn(m.set + ": " + m.best.message);
  for (const ComparedMotion& m : c.motions)
    for (const std::optional<Landing>& l : m.landings)
      if (l && no_landing(l->end)) run.warn(failure_words(*l));
  for (const ComparedMotion& m : c.motions)
    for (std::size_t s = 0; s < 2; ++s)
      if (m.landings[s]) warn_of(*m.landings[s], fmt::format("best for {}, with {}: ", m.set, kSets[s]), run);
}

/// What planning with the nominal constants would have cost on the identified actuator.
std::string lesson_of(const Comparison& c) {
  const double own = c.motions[1].landings[1]->peak, nominal = c.motions[0].landings[1]->peak,
               promised = c.motions[0].landings[0]->peak;
  return fmt::format(
      "Planned with the nominal constants, the identified actuator hits with {:.4g} m/s^2 where {:.4g} was promised: "
      "{:.2f} "
      "times the {:.4g} m/s^2 of the motion planned with its own constants.",
      nominal, promised, nominal / own, own);
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

}  // namespace

int report(const Comparison& c, Json summary, Run& run) {
  warn(c, run);
  Report report("Identified against nominal");
  report.paragraph("nominal: " + c.sets[0].name + "; identified: " + c.sets[1].name);
  report.distrust(run.warnings());

  const Table constants(kConstantQuantities, c.constants);
  summary["parameters"] = constants.keyed();
  report.heading("Constants");
  (void)tell(constants, report, run, "parameters.csv",
             "z: difference in standard errors of the identified constant; inside_ci95: the nominal value inside its "
             "95 % interval.");

  if (c.predictions) {
    const Table rows(residual_quantities(c), c.measured->trials);
    summary["residuals"] = rows.objects();
    run.say(fmt::format("residual rms over {} trials: nominal {:.4g} rad, identified {:.4g} rad",
                        c.measured->trials.size(), (*c.predictions)[0].rms, (*c.predictions)[1].rms));
    report.heading("Residuals on the trials, rms");
    report.table(rows);
  }

  for (const ComparedMotion& m : c.motions) {
    if (!m.best.found) continue;
    summary["motions"][m.set] = motion_json(m.best.motion);
    summary["tolerant_peaks"][m.set] = m.best.tolerant.complete ? number(m.best.tolerant.value) : Json();
  }
  if (!c.plans.empty()) {
    const Table plans(plan_quantities(), c.plans);
    summary["plans"] = plans.objects();
    report.heading("Plans for scattered drops, where the identified constants are the truth");
    (void)tell(plans, report, run);
  }
  if (c.landed()) {
    const Table peaks(kPeakQuantities, c.motions);
    for (std::size_t m = 0; m < 2; ++m) summary["peaks"][c.motions[m].set + "_motion"] = peaks.object(m);
    report.heading("Peak |ddr_0| on " + c.scene->name);
    floor_source(report, *c.scene);
    (void)tell(peaks, report, run);
    run.add("trajectories.csv", trajectories_csv(c, run));
    const std::string lesson = lesson_of(c);
    run.say(lesson), report.paragraph(lesson);
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

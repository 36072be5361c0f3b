#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "landing/model/scene_file.hpp"
#include "tools/program/interrupt.hpp"
#include "tools/report/estimates.hpp"
#include "tools/report/results.hpp"
#include "tools/study/calibration.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

/// An output that some drop measured, over all drops.
Quantities<std::size_t> output_quantities(const Calibration& c) {
  return {
      {"", "", "output", {}, [](auto& o) { return kOutputNames[o]; }},
      {"", "rms", "residual rms", "{:.3g}", [&c](auto& o) { return c.rms[o]; }},
      {"", "noise", "the logs' noise", "{:.3g}", [&c](auto& o) { return c.noise[o]; }},
      {"", "unit", "unit", {}, [](auto& o) { return kOutputUnits[o]; }},
  };
}
std::vector<std::size_t> measured(const Calibration& c) {
  std::vector<std::size_t> out;
  for (std::size_t o = 0; o < kOutputs; ++o)
    if (std::isfinite(c.noise[o])) out.push_back(o);
  return out;
}

Quantities<DropResult> drop_quantities(const Calibration& c) {
  Quantities<DropResult> out = {{"", "file", "drop", {}, &DropResult::file}, {"", "simulated", &DropResult::simulated}};
  for (const std::size_t o : measured(c))
    out.push_back({"", std::string("rms/") + kOutputNames[o],
                   fmt::format("{} rms [{}]", kOutputNames[o], kOutputUnits[o]), "{:.3g}",
                   [o](auto& d) { return d.rms[o]; }});
  out.push_back({"", "peak_measured", "peak measured [m/s^2]", "{:.4g}", &DropResult::peak_measured});
  out.push_back({"", "peak_simulated", "simulated at the samples [m/s^2]", "{:.4g}", &DropResult::peak_simulated});
  out.push_back({"", "peak_between_samples", "and between them [m/s^2]", "{:.4g}", &DropResult::peak_between});
  return out;
}

std::string samples_csv(const Run& run, const CalibratedDrops& c) {
  CsvWriter csv = run.csv();
  csv.comment(
      "residual = simulated - measured; drop counts from 1; t as in the log; used 0: left out, an acceleration "
      "within a sampling interval of a simulated touchdown or lift-off. Units: s, m, rad, m/s^2.");
  csv.header({"drop", "t", "output", "measured", "simulated", "residual", "used"});
  for (std::size_t m = 0; m < c.drops.size(); ++m)
    for (std::size_t o = 0; o < kOutputs; ++o) {
      const DropResult& result = c.result.drops[m];
      for (std::size_t i = 0; i < result.value[o].size(); ++i) {
        const double log = c.drops[m].log.output[o][i], simulated = result.value[o][i];
        if (!std::isfinite(log) || !std::isfinite(simulated)) continue;
        csv.cell(long(m + 1)).cell(c.drops[m].log.t[i]).cell(kOutputNames[o]).cell(log).cell(simulated);
        csv.cell(simulated - log).cell(int(result.used[o][i])).end_row();
      }
    }
  return csv.text();
}

/// The scene with the fitted constants.
std::string scene_toml(const Run& run, const Calibration& c) {
  std::string comments = run.provenance_text();
  for (const auto& e : c.parameters)
    comments += fmt::format("{}: {}: {}\n", e.name, value_words(e), identify::name(e.verdict));
  if (!c.converged) comments += "not converged: these constants are not a minimum\n";
  return to_toml(c.scene, comments);
}

/// A drop's outputs side by side, drop_1 or validation_1, measured and simulated; lines where the simulation touches
/// down and lifts off.
Figure drop_figure(const LoggedDrop& drop, const DropResult& result, const char* set, std::size_t number) {
  Figure out;
  out.name = fmt::format("{}_{}", set, number), out.width = Figure::Width::kWhole, out.panel_height = 200;
  for (std::size_t o = 0; o < kOutputs; ++o) {
    const std::vector<double>&measured = drop.log.output[o], &simulated = result.value[o];
    if (simulated.empty()) continue;
    Panel p;
    p.title = kOutputNames[o], p.x_label = "t [s]", p.y_label = kOutputUnits[o];
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const std::vector<double>* values : {&measured, &simulated})
      for (const double v : *values)
        if (std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
    for (const double t : result.jumps)
      p.series.push_back({"", {t, t}, {low, high}, Series::Look::kFaint, Series::kGrey});
    p.series.push_back({"", drop.log.t, measured, Series::Look::kPoints, 0});
    p.series.push_back({"", drop.log.t, simulated, Series::Look::kLine, 1});
    out.panels.push_back(std::move(p));
  }
  out.columns = int(std::min<std::size_t>(4, out.panels.size()));
  out.caption = fmt::format(
      "Drop {}, {}: measured (points) and simulated (line); grey: where the simulation touches down and lifts off. All "
      "samples: fit.csv.",
      number, drop.log.file);
  return out;
}

/// What the tests of the floor find, a sentence each.
std::vector<std::string> findings(const Calibration& c) {
  std::vector<std::string> out;
  const identify::ResidualTests& tests = c.tests;
  if (const identify::ScoreTest* missed = tests.missing()) {
    const std::string& term = missed->term;
    const bool held = std::any_of(c.parameters.begin(), c.parameters.end(), [&](auto& e) { return e.name == term; });
    out.push_back(fmt::format(
        "the drops ask for {}{} (score test, p {}): of what was not fitted it explains most of the residuals, their "
        "rms "
        "would fall from {:.4g} to {:.4g} standard deviations: try {}",
        held ? "another value of " : "", term, probability_words(missed->p), std::sqrt(tests.score->variance),
        tests.rms_with(*missed), held ? "--free with it" : "--nuisance " + term));
  }
  if (tests.whiteness.rejected)
    out.push_back(fmt::format("the residuals are not white (Ljung-Box, p {}; neighbours correlate by {:.2f})",
                              probability_words(tests.whiteness.p), tests.whiteness.correlation));
  for (std::size_t m = 0; m < tests.chow.size(); ++m)
    if (tests.disagrees(m))
      out.push_back(fmt::format("{} disagrees with the other drops (Chow's test, p {}): it asks for a floor of its own",
                                c.drops[m].file, probability_words(tests.chow[m])));
  if (tests.model_rejected())
    out.push_back(fmt::format(
        "the floor does not explain these drops: no constant is trusted, and the errors are widened to what "
        "the residuals say (tests at {:g} % together); the true ones may be larger still. Every plan on "
        "this scene rests on it",
        100 * identify::kTestLevel));
  return out;
}

/// "outputs" and "drops" of the summary, as tables and, drop by drop, as figures.
void tell_drops(const CalibratedDrops& c, const char* set, Report& report, Json& summary, Run& run) {
  const Table outputs(output_quantities(c.result), measured(c.result));
  summary["outputs"] = outputs.keyed();
  (void)tell(outputs, report, run);
  summary["drops"] = tell(Table(drop_quantities(c.result), c.result.drops), report, run);
  constexpr std::size_t kMost = 12;
  for (std::size_t m = 0; m < std::min(kMost, c.drops.size()); ++m)
    report.figure(drop_figure(c.drops[m], c.result.drops[m], set, m + 1));
}

}  // namespace

int report(const CalibratedDrops& fitted, const std::optional<CalibratedDrops>& validation, Doubt doubt, Run& run) {
  const Calibration& c = fitted.result;
  for (const std::string& w : c.warnings) run.warn(w);
  for (const std::string& finding : findings(c)) run.warn(finding);
  if (!c.converged && !interrupted())
    run.warn("not converged: " + c.message + "; try another start in the scene, --prior, or fewer --free constants");
  Report report("Calibration");
  Json summary;
  bool converged = c.converged;
  if (validation) {
    for (const std::string& w : validation->result.warnings) run.warn("validation: " + w);
    if (!validation->result.converged) run.warn("validation: " + validation->result.message), converged = false;
  }
  begin(c, constant_quantities(), report, summary, run);
  summary["trusted"] = c.trusted();
  summary["steps"] = c.steps;
  report.heading("Does the floor explain the drops?");
  tell_tests(c.tests, "standard deviations", report, summary["diagnostics"]);
  report.heading("Fitted drops");
  tell_drops(fitted, "drop", report, summary, run);
  if (validation) {
    run.say("not fitted:");
    report.heading("Validation: drops that were not fitted");
    Json& j = summary["validation"];
    j["nuisance"] = nuisance_json(validation->result.nuisance);
    tell_drops(*validation, "validation", report, j, run);
    run.add("validation.csv", samples_csv(run, *validation));
  }
  run.add("scene.toml", scene_toml(run, c));
  run.add("fit.csv", samples_csv(run, fitted));
  report.write(run);
  return run.finish(summary, converged && (doubt == Doubt::kReport || c.trusted()) ? kDone : kNumbers);
}

}  // namespace ukemi::tools

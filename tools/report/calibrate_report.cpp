#include "tools/report/calibrate_report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "landing/model/scene_file.hpp"

namespace ukemi::tools {

using namespace landing;

std::string words(const identify::Estimate& e) {
  std::string text = text_of(e) + " " + e.unit;
  if (e.unit == "rad" && std::isfinite(e.value))
    text += e.std ? fmt::format(" ({:.5g} ± {:.2g} deg)", e.value * kDegrees, *e.std * kDegrees)
                  : fmt::format(" ({:.5g} deg)", e.value * kDegrees);
  return text;
}

std::string samples_csv(const Run& run, const std::vector<LoggedDrop>& drops, const std::vector<DropResult>& results) {
  CsvWriter csv = run.csv();
  csv.comment(
      "residual = simulated - measured; drop counts from 1; t as in the log; used 0: left out, an acceleration "
      "within a sampling interval of a simulated touchdown or lift-off. Units: s, m, rad, m/s^2.");
  csv.header({"drop", "t", "output", "measured", "simulated", "residual", "used"});
  for (std::size_t m = 0; m < drops.size(); ++m)
    for (std::size_t o = 0; o < kOutputs; ++o)
      for (std::size_t i = 0; i < results[m].value[o].size(); ++i) {
        const double measured = drops[m].log.output[o][i], simulated = results[m].value[o][i];
        if (!std::isfinite(measured) || !std::isfinite(simulated)) continue;
        csv.cell(long(m + 1)).cell(drops[m].log.t[i]).cell(kOutputNames[o]).cell(measured).cell(simulated);
        csv.cell(simulated - measured).cell(int(results[m].used[o][i]));
        csv.end_row();
      }
  return csv.text();
}

Json drops_json(const Calibration& c) {
  Json out = Json::array();
  for (const DropResult& d : c.drops) {
    Json j{{"file", d.file}, {"simulated", d.simulated}};
    for (std::size_t o = 0; o < kOutputs; ++o)
      if (std::isfinite(c.noise[o])) j["rms"][kOutputNames[o]] = number(d.rms[o]);
    j["peak_measured"] = number(d.peak_measured);
    j["peak_simulated"] = number(d.peak_simulated);
    j["peak_between_samples"] = number(d.peak_between);
    out.push_back(j);
  }
  return out;
}
Json outputs_json(const Calibration& c) {
  Json out;
  for (std::size_t o = 0; o < kOutputs; ++o)
    if (std::isfinite(c.noise[o]))
      out[kOutputNames[o]] = {{"rms", number(c.rms[o])}, {"noise", number(c.noise[o])}, {"unit", kOutputUnits[o]}};
  return out;
}
Json nuisance_json(const Calibration& c) {
  Json out = Json::object();
  for (const auto& e : c.nuisance) out[e.name].push_back(estimate_json(e));
  return out;
}

void say_drops(const Run& run, const Calibration& c) {
  for (const DropResult& d : c.drops) {
    std::string text = d.file + ":";
    for (std::size_t o = 0; o < kOutputs; ++o)
      if (std::isfinite(d.rms[o]))
        text +=
            fmt::format(" {} rms {:.3g} {} (noise {:.3g});", kOutputNames[o], d.rms[o], kOutputUnits[o], c.noise[o]);
    if (std::isfinite(d.peak_measured))
      text += fmt::format(" peak {:.4g} measured, {:.4g} simulated m/s^2 at the samples, {:.4g} between them",
                          d.peak_measured, d.peak_simulated, d.peak_between);
    run.say(text);
  }
}

namespace {
void report_drops(Report& report, const std::vector<LoggedDrop>& drops, const Calibration& c) {
  std::vector<std::vector<std::string>> rows;
  for (const DropResult& d : c.drops) {
    std::string rms;
    for (std::size_t o = 0; o < kOutputs; ++o)
      if (std::isfinite(d.rms[o]))
        rms += fmt::format("{} {:.3g} / {:.3g} {}; ", kOutputNames[o], d.rms[o], c.noise[o], kOutputUnits[o]);
    const auto peak = [](double x) { return std::isfinite(x) ? fmt::format("{:.4g}", x) : std::string(); };
    rows.push_back({d.file, rms, peak(d.peak_measured), peak(d.peak_simulated), peak(d.peak_between)});
  }
  report.table({"drop", "residual rms / the logs' noise", "peak measured [m/s²]", "simulated at the samples",
                "and between them"},
               rows);
  for (std::size_t m = 0; m < drops.size() && m < 12; ++m)
    for (std::size_t o = 0; o < kOutputs; ++o) {
      if (c.drops[m].value[o].empty()) continue;
      report.paragraph(drops[m].log.file + ": " + kOutputNames[o]);
      report.plot(
          "t [s]", fmt::format("{} [{}]", kOutputNames[o], kOutputUnits[o]),
          {{"measured", drops[m].log.t, drops[m].log.output[o]}, {"simulated", drops[m].log.t, c.drops[m].value[o]}});
    }
}
}  // namespace

std::string scene_toml(const Run& run, const Calibration& c) {
  std::string comments = run.provenance_text();
  for (const auto& e : c.parameters)
    comments += fmt::format("{}: {}: {}\n", e.name, words(e), identify::name(e.verdict));
  if (!c.converged) comments += "not converged: these constants are not a minimum\n";
  return to_toml(c.scene, comments);
}

std::string calibration_html(const Run& run, const std::vector<LoggedDrop>& drops, const Calibration& c,
                             const std::vector<LoggedDrop>& unseen, const Calibration* validation) {
  Report report("Calibration");
  report.paragraph(c.converged ? "Done." : "Not converged: " + c.message);
  report.list(run.warnings());
  report.heading("Constants");
  std::vector<std::vector<std::string>> rows;
  for (const auto& e : c.parameters) rows.push_back({e.name, words(e), interval_of(e), identify::name(e.verdict)});
  for (const auto& e : c.nuisance)
    rows.push_back({fmt::format("{} (drop {})", e.name, e.trial + 1), words(e), interval_of(e), ""});
  report.table({"constant", "value ± standard error", "95 % interval", "verdict"}, rows);
  if (c.correlation.rows() > 1) add_correlations(report, c.fitted, c.correlation);
  if (validation) {
    report.heading("Validation: drops that were not fitted");
    report_drops(report, unseen, *validation);
  }
  report.heading("Fitted drops");
  report_drops(report, drops, c);
  return report.html(run.provenance());
}

}  // namespace ukemi::tools

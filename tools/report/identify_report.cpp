#include "tools/report/identify_report.hpp"

#include <fmt/format.h>

#include <limits>

namespace ukemi::tools {

Json minima_json(const identify::Fit& fit) {
  Json list = Json::array();
  for (const identify::Minimum& m : fit.minima) {
    Json one{{"cost", number(m.cost)}, {"found", m.found}};
    const auto u = constants(m.sea);
    for (std::size_t k = 0; k < kConstants; ++k) one[kConstantNames[k]] = number(u[k]);
    list.push_back(one);
  }
  return list;
}

std::string fit_csv(const Run& run, const std::vector<identify::Trial>& trials, const identify::Fit& fit) {
  CsvWriter csv = run.csv();
  bool motor = false;
  for (const auto& t : trials) motor = motor || !t.phi_motor.empty();
  csv.comment("residual = phi_sim - phi; trial counts from 1. Units: s, rad.");
  std::vector<std::string> header = {"trial", "t", "phi", "phi_sim", "residual"};
  if (motor) header.insert(header.end(), {"phi_motor", "phi_motor_sim", "residual_motor"});
  csv.header(header);
  const double kNone = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t m = 0; m < trials.size(); ++m) {
    const identify::Trial& t = trials[m];
    const identify::TrialResult& r = fit.trials[m];
    for (std::size_t i = 0; i < t.samples(); ++i) {
      const double phi = t.phi.empty() ? kNone : t.phi[i], sim = r.phi.empty() ? kNone : r.phi[i];
      csv.cell(long(m + 1)).cell(t.t[i]).cell(phi).cell(sim).cell(sim - phi);
      if (motor) {
        const double measured = t.phi_motor.empty() ? kNone : t.phi_motor[i],
                     sim_m = r.phi_m.empty() ? kNone : r.phi_m[i];
        csv.cell(measured).cell(sim_m).cell(sim_m - measured);
      }
      csv.end_row();
    }
  }
  return csv.text();
}

std::string identification_html(const Run& run, const std::string& title, const std::vector<identify::Trial>& trials,
                                const identify::Fit& fit, const std::optional<Trust>& trust) {
  Report report(title);
  report.paragraph(fit.converged ? "Done." : "Not converged: " + fit.message);
  report.list(run.warnings());
  report.heading("Constants");
  std::vector<std::vector<std::string>> rows;
  const auto row = [&](const identify::Estimate& e, const std::string& name) {
    rows.push_back({name, text_of(e), interval_of(e), e.unit});
  };
  for (const auto& e : fit.parameters) row(e, e.name), rows.back().push_back(identify::name(e.verdict));
  for (const auto& e : fit.nuisance) row(e, e.trial < 0 ? e.name : fmt::format("{} (trial {})", e.name, e.trial + 1));
  for (auto& r : rows) r.resize(5);
  report.table({"constant", "value ± standard error", "95 % interval", "unit", "verdict"}, rows);
  if (fit.correlation.rows() > 1) {
    add_correlations(report, fit.fitted, fit.correlation);
    std::string eigenvalues = "Eigenvalues of the scaled Fisher information, largest 1:";
    for (const double e : fit.eigenvalues) eigenvalues += fmt::format(" {:.3g}", e);
    report.paragraph(eigenvalues);
  }
  if (trust) add_section(report, *trust, fit);
  report.heading("Trials");
  rows.clear();
  for (std::size_t m = 0; m < trials.size(); ++m)
    rows.push_back({trials[m].file, std::to_string(trials[m].samples()), fmt::format("{:.4g}", fit.trials[m].rms),
                    fmt::format("{:.4g}", fit.trials[m].noise), identify::name(fit.trials[m].status)});
  report.table({"file", "samples", "residual rms [rad]", "log's own noise [rad]", "rollout"}, rows);
  for (std::size_t m = 0; m < trials.size() && m < 12; ++m) {
    report.heading(trials[m].file);
    std::vector<Series> series;
    if (!trials[m].phi.empty()) series.push_back({"measured", trials[m].t, trials[m].phi});
    if (!fit.trials[m].phi.empty()) series.push_back({"predicted", trials[m].t, fit.trials[m].phi});
    if (!trials[m].phi_motor.empty()) series.push_back({"motor, measured", trials[m].t, trials[m].phi_motor});
    if (!trials[m].phi_motor.empty() && !fit.trials[m].phi_m.empty())
      series.push_back({"motor, predicted", trials[m].t, fit.trials[m].phi_m});
    report.plot("t [s]", "phi_1 [rad]", series);
  }
  return report.html(run.provenance());
}

}  // namespace ukemi::tools

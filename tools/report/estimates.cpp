#include "tools/report/estimates.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace ukemi::tools {

using identify::Estimate;

std::string value_words(const Estimate& e) {
  const std::string note = !e.free ? " (fixed)" : e.at_bound ? " (at bound)" : " (not determined)";
  const bool error = e.std && e.free && !e.at_bound;
  std::string text = (error ? with_error(e.value, *e.std) : fmt::format("{:.6g}", e.value) + note) + " " + e.unit;
  if (e.unit == "rad" && std::isfinite(e.value))
    text += e.std ? " (" + with_error(e.value * kDegrees, *e.std * kDegrees) + " deg)"
                  : fmt::format(" ({:.5g} deg)", e.value * kDegrees);
  return text;
}

namespace {

std::string label(const Estimate& e) { return e.trial < 0 ? e.name : fmt::format("{}[{}]", e.name, e.trial + 1); }
Json interval(const Estimate& e) { return e.std ? Json{e.ci_low, e.ci_high} : Json(); }
std::string interval_words(const Estimate& e) {
  return e.std ? fmt::format("{:.6g} .. {:.6g}", e.ci_low, e.ci_high) : "";
}

/// A matrix as an array of rows; null for NaN and infinities.
Json matrix_json(const Eigen::MatrixXd& m) {
  Json rows = Json::array();
  for (long i = 0; i < m.rows(); ++i) {
    rows.push_back(Json::array());
    for (long j = 0; j < m.cols(); ++j) rows.back().push_back(number(m(i, j)));
  }
  return rows;
}

/// Adds a section with the correlation matrix.
void add_correlations(Report& report, const std::vector<std::string>& names, const Eigen::MatrixXd& correlation) {
  report.heading("Correlations");
  std::vector<std::vector<double>> rows;
  for (long i = 0; i < correlation.rows(); ++i) {
    rows.emplace_back();
    for (long j = 0; j < correlation.cols(); ++j) rows.back().push_back(correlation(i, j));
  }
  report.matrix(names, rows);
}

}  // namespace

Quantities<Estimate> estimate_quantities() {
  return {
      {"", "", "constant", {}, label},
      {"", "value", &Estimate::value},
      {"", "std", [](auto& e) { return number(e.std); }},
      {"", "std_noise", [](auto& e) { return number(e.std_noise); }},
      {"", "ci95", interval},
      {"", "unit", &Estimate::unit},
      {"", "at_bound", &Estimate::at_bound},
      {"", "free", &Estimate::free},
      {"", "", "value ± standard error", {}, value_words},
      {"", "", "95 % interval", {}, interval_words},
  };
}
Quantities<Estimate> constant_quantities() {
  Quantities<Estimate> out = estimate_quantities();
  out.push_back({"", "verdict", "verdict", {}, [](auto& e) { return e.trial < 0 ? identify::name(e.verdict) : ""; }});
  return out;
}

Json nuisance_json(const std::vector<Estimate>& nuisance) {
  Json out = Json::object();
  const Table table(estimate_quantities(), nuisance);
  for (std::size_t i = 0; i < nuisance.size(); ++i)
    if (Json& j = out[nuisance[i].name]; nuisance[i].trial < 0)
      j = table.object(i);
    else
      j.push_back(table.object(i));
  return out;
}

FirstScreen first_screen(const identify::Estimates& fit, const std::string& from) {
  long trusted = 0, fitted = 0;
  for (const Estimate& e : fit.parameters)
    fitted += e.free, trusted += e.verdict == identify::Identifiability::kTrusted;
  const std::string share = fmt::format("{} of {} fitted constants", trusted, fitted);
  return {share + " are trusted, from " + from + ".",
          {converged(fit.converged, fit.message), check(fit.trusted(), "trusted", share)},
          ""};
}

void begin_report(const identify::Estimates& fit, const Quantities<Estimate>& quantities, Report& report, Json& summary,
                  Run& run) {
  std::vector<Estimate> all = fit.parameters;
  all.insert(all.end(), fit.nuisance.begin(), fit.nuisance.end());
  const bool none_fitted = std::ranges::none_of(fit.parameters, &Estimate::free);
  std::vector<Estimate> shared;  // fitted terms of all trials
  std::ranges::copy_if(all, std::back_inserter(shared),
                       [&](const Estimate& e) { return (e.free || none_fitted) && e.trial < 0; });
  summary["parameters"] = Table(quantities, fit.parameters).keyed();
  summary["nuisance"] = nuisance_json(fit.nuisance);
  summary["cost"] = number(fit.cost);
  summary["converged"] = fit.converged;
  summary["iterations"] = fit.iterations;
  summary["starts"] = fit.starts;
  summary["fitted"] = fit.fitted;
  summary["correlation"] = matrix_json(fit.correlation);
  summary["eigenvalues"] = std::vector<double>(fit.eigenvalues.begin(), fit.eigenvalues.end());
  report.distrust(run.warnings());
  report.heading("Constants");
  say(Table(quantities, shared), run);
  if (const std::size_t omitted = all.size() - shared.size(); omitted > 0)
    run.say(fmt::format("{} more, as given or of one log alone: see summary.json", omitted));
  report.table(Table(quantities, all));
  if (fit.correlation.rows() > 1) add_correlations(report, fit.fitted, fit.correlation);
}

std::vector<identify::ErrorBudget> report_error_shares(const identify::Estimates& fit, const std::string& stated,
                                                       Report& report, Json& summary, Run& run) {
  using identify::ErrorBudget;
  const std::vector<ErrorBudget> budget = identify::error_budget(fit);
  Json& j = summary["error_budget"] = Json::object();
  for (const ErrorBudget& b : budget)
    for (const auto& [source, share] : b.shares) j[b.constant][source] = number(share);
  if (budget.empty() || fit.considered.empty()) return budget;
  Quantities<ErrorBudget> columns = {{"", "", "share of the variance [%]", {}, &ErrorBudget::constant}};
  for (std::size_t i = 0; i <= fit.considered.size(); ++i)
    columns.push_back({"", "", i == 0 ? "noise" : fit.considered[i - 1].name, "{:.1f}",
                       [i](const ErrorBudget& b) { return number(100 * b.shares[i].second); }});
  report.heading("Where the errors come from");
  report.paragraph("Standard errors and intervals are the whole: the logs' noise, and what was not fitted, " + stated +
                   ".");
  (void)add_table(Table(columns, budget), report, run);
  return budget;
}

}  // namespace ukemi::tools

// What every fit tells: its estimates, how they hang together, how it ended.
#pragma once

#include <string>
#include <vector>

#include "identify/estimate/uncertainty.hpp"
#include "tools/report/report.hpp"
#include "tools/report/table.hpp"

namespace ukemi::tools {

enum class Doubt { kReport, kFail };  ///< kFail: anything but trusted is exit 1

Quantities<identify::Estimate> estimate_quantities();
/// And its verdict.
Quantities<identify::Estimate> constant_quantities();
/// Value, standard error and unit, or why there is no error; an angle in degrees too.
std::string words(const identify::Estimate& estimate);
/// "nuisance" of summary.json: a list for a term that each trial has.
Json nuisance_json(const std::vector<identify::Estimate>& nuisance);
/// Row by row, null where it is not a number.
Json matrix_json(const Eigen::MatrixXd& matrix);
/// A section with the table.
void add_correlations(Report& report, const std::vector<std::string>& names, const Eigen::MatrixXd& correlation);

/// Begins the report, the summary and the lines on the terminal, of a Fit or a Calibration.
template <class Fit>
void begin(const Fit& fit, const Quantities<identify::Estimate>& quantities, Report& report, Json& summary, Run& run) {
  std::vector<identify::Estimate> all = fit.parameters;
  all.insert(all.end(), fit.nuisance.begin(), fit.nuisance.end());
  const Table table(quantities, all);
  for (std::size_t i = 0; i < fit.parameters.size(); ++i)
    summary["parameters"][fit.parameters[i].name] = table.object(i);
  summary["nuisance"] = nuisance_json(fit.nuisance);
  summary["cost"] = number(fit.cost);
  summary["converged"] = fit.converged;
  summary["iterations"] = fit.iterations;
  summary["starts"] = fit.starts;
  summary["fitted"] = fit.fitted;
  summary["correlation"] = matrix_json(fit.correlation);
  summary["eigenvalues"] = std::vector<double>(fit.eigenvalues.begin(), fit.eigenvalues.end());
  say(table, run);
  report.paragraph(fit.converged ? "Done." : "Not converged: " + fit.message);
  report.list(run.warnings());
  report.heading("Constants");
  report.table(table);
  if (fit.correlation.rows() > 1) add_correlations(report, fit.fitted, fit.correlation);
}

}  // namespace ukemi::tools

// What the reports of all fits share: estimates, correlations, convergence, residual tests.
#pragma once

#include <string>
#include <vector>

#include "identify/trust/profile.hpp"
#include "tools/report/report.hpp"
#include "tools/report/table.hpp"

namespace ukemi::tools {

enum class Doubt { kReport, kFail };  ///< kFail: anything but trusted is exit 1

Quantities<identify::Estimate> estimate_quantities();
/// Columns of estimate_quantities() and the verdict.
Quantities<identify::Estimate> constant_quantities();
/// Value, standard error and unit, or why there is no error; an angle in degrees too.
std::string value_words(const identify::Estimate& estimate);
/// "nuisance" of summary.json; a list where a term has a value for each trial.
Json nuisance_json(const std::vector<identify::Estimate>& nuisance);
/// How many constants are trusted, and the checks that all fits share; `from`: "8 trials".
FirstScreen first_screen(const identify::Estimates& fit, const std::string& from);
/// Writes warnings, constants and correlations to report, summary and terminal.
void begin_report(const identify::Estimates& fit, const Quantities<identify::Estimate>& quantities, Report& report,
                  Json& summary, Run& run);

/// "error_budget" of the summary and, where errors of unfitted constants count, its table; `stated`: describes them.
/// Returns the budget.
std::vector<identify::ErrorBudget> report_error_shares(const identify::Estimates& fit, const std::string& stated,
                                                       Report& report, Json& summary, Run& run);

// --- residual tests and likelihood profiles, trust.cpp ---

/// A probability to two digits; "below 1e-16".
std::string probability_words(double p);
/// Findings of the tests; `model` and `logs`: what was fitted to what.
std::string not_white_words(const identify::ResidualTests& tests);
std::string rejected_words(const identify::ResidualTests& tests, const std::string& model, const std::string& logs);
/// "diagnostics" of the summary, and the tables of the tests; `unit` is that of the residuals.
void report_tests(const identify::ResidualTests& tests, const std::string& unit, Report& report, Json& diagnostics);

/// "profile" of the diagnostics, a figure of each profile, profile.csv.
void report_profiles(const std::vector<identify::Profile>& profiles, const identify::Estimates& fit, Report& report,
                     Json& diagnostics, Run& run);

}  // namespace ukemi::tools

// What every fit tells: its estimates, how they hang together, how it ended.
#pragma once

#include <string>
#include <vector>

#include "identify/trust/profile.hpp"
#include "tools/report/report.hpp"
#include "tools/report/table.hpp"

namespace ukemi::tools {

enum class Doubt { kReport, kFail };  ///< kFail: anything but trusted is exit 1

Quantities<identify::Estimate> estimate_quantities();
/// And its verdict.
Quantities<identify::Estimate> constant_quantities();
/// Value, standard error and unit, or why there is no error; an angle in degrees too.
std::string value_words(const identify::Estimate& estimate);
/// What a rejected model's errors are: widened, where the residuals' derivatives tell how far.
std::string widened_words(const identify::ResidualTests& tests);
/// "nuisance" of summary.json: a list for a term that each trial has.
Json nuisance_json(const std::vector<identify::Estimate>& nuisance);
/// How many constants are trusted, `from` "8 trials", and the checks that every fit has.
FirstScreen first_screen(const identify::Estimates& fit, const std::string& from);
/// Begins the report, the summary and the lines on the terminal.
void begin(const identify::Estimates& fit, const Quantities<identify::Estimate>& quantities, Report& report,
           Json& summary, Run& run);

/// "error_budget" of the summary and, where errors of what was not fitted count, the table of where errors come from;
/// `stated`: how far they do. Returns the budget.
std::vector<identify::ErrorBudget> report_shares(const identify::Estimates& fit, const std::string& stated,
                                                 Report& report, Json& summary, Run& run);

// --- what the residuals say against a fit, trust.cpp ---

/// A probability for a reader.
std::string probability_words(double p);
/// "diagnostics" of the summary, and the tables of the tests; `unit` is that of the residuals.
void report_tests(const identify::ResidualTests& tests, const std::string& unit, Report& report, Json& diagnostics);

/// "profile" of the diagnostics, a figure each, profile.csv.
void report_profiles(const std::vector<identify::Profile>& profiles, const identify::Estimates& fit, Report& report,
                     Json& diagnostics, Run& run);

}  // namespace ukemi::tools

// Reports of `ukemi identify` and `ukemi predict`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/actuator.hpp"
#include "identify/trust/identification.hpp"
#include "identify/trust/prediction.hpp"
#include "tools/program/output.hpp"
#include "tools/report/estimates.hpp"
#include "tools/report/exports.hpp"
#include "tools/study/landing_of_fit.hpp"

namespace ukemi::tools {

extern const Outputs kPredictOutputs, kIdentifyOutputs;

struct IdentifyQuestion {
  enum class Verb { kIdentify, kPredict } verb = Verb::kIdentify;
  identify::Rig rig;
  std::vector<identify::Trial> trials;
  identify::FitOptions options;
  std::optional<Actuator> given;  ///< the start of a fit, or the constants of a prediction
  SeaParameters<double> base;     ///< unfitted constants: limit, feedback, friction
  Exports exports;
};

/// Unfitted constants: of the given actuator, else no limit and Eq. 3 as printed. The rig's limit and feedback take
/// precedence.
SeaParameters<double> base_of(const identify::Rig& rig, const std::optional<Actuator>& given);
/// Fits K_t instead of K_p and K_d where every trial's rig has a [drive]. Throws InputError where only some do.
void choose_drive(IdentifyQuestion& question);
/// The actuator as its file holds it: constants, verdicts, covariance, ratings.
Actuator fitted_actuator(const IdentifyQuestion& question, const identify::Fit& fit);
/// The angles of a trial, measured and predicted.
std::vector<Series> angle_curves(const identify::Trial& trial, const identify::TrialResult& predicted);

/// Completes `summary`, which holds what was read, and writes the files. Returns the exit code. `landing`: effect of
/// the fit's errors on a landing, if requested.
int report(const IdentifyQuestion& question, const identify::Identification& found,
           const std::optional<LandingOfFit>& landing, Doubt doubt, Json summary, Run& run);
/// Report of a prediction, predict.cpp; with Doubt::kFail the exit code is 1 where it does not hold.
int report(const IdentifyQuestion& question, const identify::Prediction& prediction, Doubt doubt, Json summary,
           Run& run);

// --- common to both ---

/// Where the torque limit and the feedback come from; `found`: of a fit.
std::string assumptions(const IdentifyQuestion& question, const identify::Identification* found = nullptr);
Quantities<identify::TrialResult> trial_quantities();
/// Measured and predicted outputs of each sample, with the 95 % band if `judged`.
std::string fit_csv(const Run& run, const std::vector<identify::Trial>& trials, const identify::Fit& fit,
                    const identify::Judgement* judged = nullptr);

// --- error budget, error_budget.cpp ---

/// "rig_errors" and "error_budget" of the summary, the table, and which measurement would reduce the errors most.
void report_error_budget(const identify::Rig& rig, const identify::Fit& fit, Report& report, Json& summary, Run& run);
/// "hang a known weight on the load cell, or weigh the link": experiments that measure these terms directly.
std::string experiments(const std::vector<std::string>& terms);

// --- tests and verdicts of a fit, trust.cpp ---

/// Warns of what the tests find.
void warn(const identify::Trust& trust, const identify::Fit& fit, Run& run);
/// "weakest" and "diagnostics" of the summary, the lines for a reader, the section of the report, profile.csv.
void report_part(const identify::Trust& trust, const identify::Fit& fit, Report& report, Json& summary, Run& run);

}  // namespace ukemi::tools

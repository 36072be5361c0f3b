// What `ukemi identify` and `ukemi predict` tell.
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
  std::optional<Actuator> given;  ///< to start from, to predict with
  SeaParameters<double> base;     ///< what is not fitted: limit, feedback, friction
  Exports exports;
};

/// What is not fitted: a given actuator's, else no limit and Eq. 3 as printed; the rig's limit and feedback count
/// before both.
SeaParameters<double> base_of(const identify::Rig& rig, const std::optional<Actuator>& given);
/// Where the command is known for every trial, K_t is fitted in place of K_p and K_d. Throws InputError where some
/// trials have a known command and others Eq. 3.
void choose_drive(IdentifyQuestion& question);
/// The actuator as its file holds it: constants, verdicts, covariance, ratings.
Actuator fitted_actuator(const IdentifyQuestion& question, const identify::Fit& fit);
/// The angles of a trial, measured and predicted.
std::vector<Series> angle_curves(const identify::Trial& trial, const identify::TrialResult& predicted);

/// Adds to a summary that holds what was read, writes the files, returns the exit code. `landing`: what the fit's
/// errors do to a landing, where that was asked for.
int report(const IdentifyQuestion& question, const identify::Identification& found,
           const std::optional<LandingOfFit>& landing, Doubt doubt, Json summary, Run& run);
/// The same of a prediction, predict.cpp; with Doubt::kFail one that does not hold is exit 1.
int report(const IdentifyQuestion& question, const identify::Prediction& prediction, Doubt doubt, Json summary,
           Run& run);

// --- what both tell ---

/// Where the torque limit and the feedback come from; `found`: of a fit.
std::string assumptions(const IdentifyQuestion& question, const identify::Identification* found = nullptr);
Quantities<identify::TrialResult> trial_quantities();
/// Of each sample what was measured and predicted, and where it was judged the band.
std::string fit_csv(const Run& run, const std::vector<identify::Trial>& trials, const identify::Fit& fit,
                    const identify::Judgement* judged = nullptr);

// --- where its errors come from, error_budget.cpp ---

/// "rig_errors" and "error_budget" of the summary, the table and what to measure better.
void report_error_budget(const identify::Rig& rig, const identify::Fit& fit, Report& report, Json& summary, Run& run);
/// "hang a known weight on the load cell, or weigh the link": what would tell these terms by themselves.
std::string experiments(const std::vector<std::string>& terms);

// --- how far it can be trusted, trust.cpp ---

/// Warns of what the tests find.
void warn(const identify::Trust& trust, const identify::Fit& fit, Run& run);
/// "weakest" and "diagnostics" of the summary, the lines for a reader, the section of the report, profile.csv.
void report_part(const identify::Trust& trust, const identify::Fit& fit, Report& report, Json& summary, Run& run);

}  // namespace ukemi::tools

// How far the result of `ukemi identify` can be trusted: what is asked for, what is found, and how it is written.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "identify/trust/ladder.hpp"
#include "identify/trust/profile.hpp"
#include "tools/program/output.hpp"
#include "tools/report/report.hpp"

namespace ukemi::tools {

struct TrustArguments {
  enum class Depth {
    kResiduals,  ///< whiteness, normality, terms that are missed: a fraction of the fit's own time
    kRefit,      ///< and the model ladder and each trial left out: several fits each
  } depth = Depth::kResiduals;
  enum class Doubt { kReport, kFail } doubt = Doubt::kReport;  ///< kFail: anything but trusted is exit 1
  std::string profile;                                         ///< constants, at commas
};

/// --strict, --diagnose, --profile.
void add_trust_options(CLI::App& verb, TrustArguments& arguments);

struct Trust {
  identify::ResidualTests tests;
  std::optional<identify::Ladder> ladder;
  std::vector<identify::LeftOut> left_out;
  std::vector<identify::Profile> profiles;
};

/// Examines a fit as deep as asked for, warns of what it finds, and lets the fit pay for it: see identify::heed. Of one
/// that did not converge only the residuals and the ladder.
Trust examine(const identify::Experiment& experiment, identify::Fit& fit, const TrustArguments& arguments, Run& run);

/// "diagnostics" and "weakest" of summary.json.
Json diagnostics_json(const Trust& trust, const identify::Fit& fit);
Json weakest_json(const identify::Fit& fit);
/// The lines for a reader.
void say(const Trust& trust, const identify::Fit& fit, const Run& run);
/// The section of the report.
void add_section(Report& report, const Trust& trust, const identify::Fit& fit);
std::string profile_csv(const Trust& trust, const Run& run);

}  // namespace ukemi::tools

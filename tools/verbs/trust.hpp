// How deep `ukemi identify` examines what it has fitted.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "tools/report/trust.hpp"

namespace ukemi::tools {

struct TrustArguments {
  enum class Depth {
    kResiduals,  ///< whiteness, normality, terms that are missed: a fraction of the fit's own time
    kRefit,      ///< and the model ladder and each trial left out: several fits each
  } depth = Depth::kResiduals;
  Doubt doubt = Doubt::kReport;
  std::string profile;  ///< constants, at commas
};

/// --strict, --diagnose, --profile.
void add_trust_options(CLI::App& verb, TrustArguments& arguments);

/// Examines a fit as deep as asked for; its errors are widened where the tests reject its model, see identify::heed. Of
/// a fit that did not converge only the residuals and the ladder.
Trust examine(const identify::Experiment& experiment, identify::Fit& fit, const TrustArguments& arguments, Run& run);

}  // namespace ukemi::tools

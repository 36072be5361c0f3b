// How deep `ukemi identify` examines what it has fitted.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "tools/report/trust.hpp"

namespace ukemi::tools {

struct TrustArguments {
  identify::TrustOptions::Depth depth = identify::TrustOptions::Depth::kResiduals;
  Doubt doubt = Doubt::kReport;
  std::string profile;  ///< constants, at commas
};

/// --strict, --diagnose, --profile.
void add_trust_options(CLI::App& verb, TrustArguments& arguments);

}  // namespace ukemi::tools

// How far the result of `ukemi identify` can be trusted, as it is written.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identify/trust/identification.hpp"
#include "tools/report/estimates.hpp"

namespace ukemi::tools {

using identify::Trust;

/// Warns of what the tests find.
void warn(const Trust& trust, const identify::Fit& fit, Run& run);
/// "weakest" and "diagnostics" of the summary, the lines for a reader, the section of the report, profile.csv.
void tell(const Trust& trust, const identify::Fit& fit, Report& report, Json& summary, Run& run);

}  // namespace ukemi::tools

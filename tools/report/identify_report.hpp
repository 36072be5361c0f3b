// What `ukemi identify` and `ukemi predict` write of a fit.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/report/estimates.hpp"
#include "tools/report/trust.hpp"

namespace ukemi::tools {

/// "minima" of summary.json.
Json minima_json(const identify::Fit& fit);
std::string fit_csv(const Run& run, const std::vector<identify::Trial>& trials, const identify::Fit& fit);
std::string identification_html(const Run& run, const std::string& title, const std::vector<identify::Trial>& trials,
                                const identify::Fit& fit, const std::optional<Trust>& trust);

}  // namespace ukemi::tools

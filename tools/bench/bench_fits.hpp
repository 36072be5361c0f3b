// Fits of stiff and extreme data, a part of `ukemi bench stability`.
#pragma once

#include "tools/report/report.hpp"

namespace ukemi::tools {

/// "cases" and "wrong" of the summary; stability_identify.csv.
Json stability_of_fits(Run& run, Report& report);

}  // namespace ukemi::tools

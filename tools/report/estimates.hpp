// Estimates in words and JSON, as every verb that fits writes them.
#pragma once

#include <string>
#include <vector>

#include "identify/fit/uncertainty.hpp"
#include "tools/program/output.hpp"
#include "tools/report/report.hpp"

namespace ukemi::tools {

Json estimate_json(const identify::Estimate& estimate);
/// Value and standard error, or why there is none.
std::string text_of(const identify::Estimate& estimate);
/// Its 95 % interval; nothing where there is none.
std::string interval_of(const identify::Estimate& estimate);
/// Row by row, null where it is not a number.
Json matrix_json(const Eigen::MatrixXd& matrix);
/// A section with the table.
void add_correlations(Report& report, const std::vector<std::string>& names, const Eigen::MatrixXd& correlation);

}  // namespace ukemi::tools

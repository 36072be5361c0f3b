// Results as they are written: on the terminal, in summary.json, in CSV files and on a page, all in report/VERB.cpp.
// Each `report` returns the exit code.
#pragma once

#include <map>
#include <string>

#include "tools/program/output.hpp"

namespace ukemi::landing {
struct Answer;
struct CheckedLanding;
struct Survey;
}  // namespace ukemi::landing

namespace ukemi::tools {

struct Comparison;

int report(const landing::CheckedLanding& landing, Run& run);
int report(const landing::Survey& survey, Run& run);
/// `summary` holds what was read.
int report(const Comparison& comparison, Json summary, Run& run);
/// `rate`: rows of motion.csv a second [Hz].
int report(const landing::Answer& answer, double rate, Run& run);
/// Every file of the answer but the summary.
std::map<std::string, std::string> files_of(const landing::Answer& answer, double rate, const Run& run);

}  // namespace ukemi::tools

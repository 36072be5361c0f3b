// Results as they are written: on the terminal, in summary.json, in CSV files and on a page, all in report/VERB.cpp.
// Each `report` returns the exit code.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tools/program/output.hpp"

namespace ukemi {
struct Actuator;
}
namespace ukemi::landing {
struct Answer;
struct CheckedLanding;
struct Landing;
struct RatedPlan;
struct Scene;
struct Survey;
}  // namespace ukemi::landing

namespace ukemi::tools {

extern const Outputs kSimulateOutputs, kOptimizeOutputs, kCalibrateOutputs, kCompareOutputs, kMapOutputs,
    kRatingsOutputs, kRiskOutputs;

struct CalibratedDrops;
struct Exports;
struct RiskStudy;
struct Comparison;
enum class Doubt;

/// Results by a shorter deadline have no curves [s]: gnuplot takes some 0.2 s, and several times that on a busy
/// machine.
inline constexpr double kDrawnFrom = 2;

/// `held`: the landing of the held reference on the same drop, to stand beside it.
int report(const landing::CheckedLanding& landing, const Actuator& actuator,
           const std::optional<landing::Landing>& held, const Exports& exports, Run& run);
int report(const landing::Survey& survey, Run& run);
int report(const landing::Scene& scene, const std::vector<landing::RatedPlan>& plans, Run& run);
int report(const RiskStudy& study, Run& run);
/// `validation`: of drops that were not fitted.
int report(const CalibratedDrops& fitted, const std::optional<CalibratedDrops>& validation, Doubt doubt, Run& run);
/// `summary` holds what was read.
int report(const Comparison& comparison, Json summary, Run& run);
/// `rate`: rows of motion.csv a second [Hz].
int report(const landing::Answer& answer, double rate, const Exports& exports, Run& run);
/// Every file of the answer but the summary.
std::map<std::string, std::string> files_of(const landing::Answer& answer, double rate, const Exports& exports,
                                            const Run& run);

}  // namespace ukemi::tools

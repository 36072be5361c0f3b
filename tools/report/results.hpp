// Reports of the verbs, defined in report/VERB.cpp: terminal, summary.json, CSV files, page. Each `report` returns the
// exit code.
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

/// Smallest deadline [s] of results with figures: gnuplot takes some 0.2 s, and several times that on a busy machine.
inline constexpr double kDrawnFrom = 2;
/// Whether a deadline leaves time to draw.
inline bool drawn(const std::optional<double>& deadline) { return !deadline || *deadline >= kDrawnFrom; }
/// In place of the figures.
inline constexpr const char* kNotDrawn =
    "The fall is not shown, for the deadline leaves no time to draw it: `ukemi simulate --motion motion.toml` does.";

/// `held`: landing of the held reference on the same drop, for comparison.
int report(const landing::CheckedLanding& landing, const Actuator& actuator,
           const std::optional<landing::Landing>& held, const Exports& exports, Run& run);
int report(const landing::Survey& survey, Run& run);
int report(const landing::Scene& scene, const std::vector<landing::RatedPlan>& plans, Run& run);
int report(const RiskStudy& study, Run& run);
/// `validation`: drops that were not fitted.
int report(const CalibratedDrops& fitted, const std::optional<CalibratedDrops>& validation, Doubt doubt, Run& run);
/// `summary` holds what was read.
int report(const Comparison& comparison, Json summary, Run& run);
/// `rate`: rows of motion.csv per second [Hz].
int report(const landing::Answer& answer, double rate, const Exports& exports, Run& run);
/// Every file of the answer but the summary.
std::map<std::string, std::string> files_of(const landing::Answer& answer, double rate, const Exports& exports,
                                            const Run& run);

}  // namespace ukemi::tools

// Quantities of peaks under scatter in reports, defined once for all verbs.
#pragma once

#include <optional>
#include <string>

#include "landing/judge/answer.hpp"
#include "tools/report/report.hpp"

namespace ukemi::tools {

/// Statistics of the peaks of one motion over many drops [m/s^2].
Quantities<landing::Distribution> distribution_quantities();

/// "peak |a| [m/s^2]", "largest load [of the rating]".
std::string distributed_words(const std::string& acceleration, bool rated);

struct NamedDistribution {
  std::string name;
  landing::Distribution of;
};
/// distribution_quantities() after a column of the motion's name with the heading `what`.
Quantities<NamedDistribution> named_quantities(const std::string& what = distributed_words("|ddr_0|", false));

/// What is minimised: "peak", "tolerant peak", "peak under scatter (mean)".
std::string goal_words(landing::Goal goal, const std::optional<landing::Measure>& measure);
std::string goal_words(const landing::AnswerOptions& options);
/// The held reference: "held at -45 deg".
std::string held_words();
/// "mean 135.0, worst tenth 175.3, 99 % below 204.7".
std::string distribution_words(const landing::Distribution& d);
/// Warns that the scatter is assumed.
void warn_of_assumed(const landing::Scatter& scatter, Run& run);
/// Warns of scattered drops that begin on the floor, for they would begin below it.
void warn_of_floor(long drops, long of, Run& run);
/// " +- 3.2", 95 %; empty where the error is not finite, as of the worst of all drops.
std::string band_words(const landing::Estimated& estimated);
/// The scatter in the notation of --scatter, and whether it is assumed; "measured drops".
std::string scatter_words(const std::optional<landing::Scatter>& scatter, bool assumed);

/// Histograms of a motion's peaks over many drops, with their quantiles, and of the one named `reference`, of
/// `reference_samples` drops. `what`: label of the x axis.
Figure histogram_figure(const std::vector<landing::PeakBin>& bins, const std::string& name,
                        const landing::Distribution& of, const std::string& reference, long reference_samples,
                        const std::string& what = distributed_words("|ddr_0|", false));

/// All measures of the peaks.
Json distribution_json(const landing::Distribution& d);
/// "robust" and "scatter" of an answer; unknown keys are absent.
Json scatter_json(const landing::Answer& answer);
/// Prints the motion under scatter and the held references, and warns where its worst tenth is worse than theirs.
void report_scatter(const landing::Answer& answer, Run& run);
/// Adds a section: the plan for scatter, the plan for the scene's own drop and holding still.
void show_scatter(const landing::Answer& answer, Report& report);

}  // namespace ukemi::tools

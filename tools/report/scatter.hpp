// What the verbs tell of peaks under scatter, each quantity once.
#pragma once

#include <optional>
#include <string>

#include "landing/judge/answer.hpp"
#include "tools/report/report.hpp"

namespace ukemi::tools {

/// Of the peaks of one motion over many drops [m/s^2].
Quantities<landing::Distribution> distribution_quantities();

/// "peak |a| [m/s^2]", "largest load [of the rating]".
std::string distributed_words(const std::string& acceleration, bool rated);

struct NamedDistribution {
  std::string name;
  landing::Distribution of;
};
/// The same with the motion's name in front, under what is distributed.
Quantities<NamedDistribution> named_quantities(const std::string& what = distributed_words("|ddr_0|", false));

/// What is minimised: "peak", "tolerant peak", "mean peak under scatter".
std::string goal_words(landing::Goal goal, const std::optional<landing::Measure>& measure);
std::string goal_words(const landing::AnswerOptions& options);
/// The reference that does nothing: "held at -45 deg".
std::string held_words();
/// "mean 135.0, worst tenth 175.3, 99 % below 204.7".
std::string distribution_words(const landing::Distribution& d);
/// Warns that nobody said how drops scatter.
void warn_of_assumed(const landing::Scatter& scatter, Run& run);
/// The scatter as its option has it, and whether it is assumed.
std::string scatter_words(const std::optional<landing::Scatter>& scatter, bool assumed);

/// `what`: is distributed. Peaks of a motion over many drops and of what stands beside it (of so many drops), with the
/// quantiles of the motion's.
Figure histogram_figure(const std::vector<landing::PeakBin>& bins, const std::string& name,
                        const landing::Distribution& of, const std::string& beside, long beside_samples,
                        const std::string& what = distributed_words("|ddr_0|", false));

/// What all measures make of the peaks.
Json distribution_json(const landing::Distribution& d);
/// "robust" and "scatter" of an answer; what is not known is absent.
Json scatter_json(const landing::Answer& answer);
/// One sentence of the motion under scatter, beside the references that do nothing; and a warning where its worst tenth
/// is worse than theirs.
void report_scatter(const landing::Answer& answer, Run& run);
/// The same on a page: the plan for scatter beside the plan for the scene's own drop and beside holding still.
void show_scatter(const landing::Answer& answer, Report& report);

}  // namespace ukemi::tools

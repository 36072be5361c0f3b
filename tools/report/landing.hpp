// What the verbs tell of motions and landings, each quantity once.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "landing/judge/checked.hpp"
#include "landing/judge/evidence.hpp"
#include "landing/judge/map.hpp"
#include "landing/judge/sensitivity.hpp"
#include "tools/report/animation.hpp"
#include "tools/report/report.hpp"
#include "tools/report/table.hpp"

namespace ukemi::tools {

inline constexpr std::array<const char*, 2> kGoalNames = {"peak", "tolerant"};  ///< of a planned drop

/// A peak for a reader: NaN is one that was not played, infinity one that could not be followed.
std::string peak_words(double peak);
std::string short_peak_words(double peak);  ///< to 4 digits
std::string percent_words(double fraction);

/// A variable as readers and files have it: angles in degrees.
struct Display {
  double factor;
  std::string key;    ///< "phi_i_deg", or with a middle "phi_i_down_deg"
  std::string words;  ///< "phi_I [deg]"
};
Display display(const landing::Variable& variable, const std::string& middle = "");

Quantities<landing::Motion> motion_quantities(const landing::Motion& like);
/// `acceleration`: how tables call the one that counts.
Quantities<landing::Touch> contact_quantities(const PointName& name = point_name,
                                              const std::string& acceleration = "|ddr_0|");
/// The worst peaks under one deviation each.
Quantities<landing::Evidence> deviation_quantities();
/// How wide the motion's basin is in each variable, its tolerant peak by that name (empty: in files alone), the
/// deviations.
Quantities<landing::Evidence> evidence_quantities(const std::vector<landing::Variable>& variables,
                                                  const std::string& tolerant_peak);

Json motion_json(const landing::Motion& motion);
/// A motion on one line.
std::string motion_words(const landing::Motion& motion);
Json contacts_json(const landing::Landing& landing);
/// "foot, knee, hip": the points in the order of their peaks; chatter left out.
std::string contact_order(const std::vector<landing::Peak>& peaks, const PointName& name = point_name);
/// Why there is no landing; `point`: what a robot meets the floor with.
std::string failure_words(const landing::RunEnd& run, const char* point = "point");

/// Warns of a run that failed, met no floor or could not be checked.
void warn_of(const landing::RunEnd& run, const landing::Sensitivity& sensitivity, const char* point, Run& to);
/// Warns of a peak that is `wrong`, see CheckedLanding, or sensitive; `accuracy`: what was asked.
void warn_of(const landing::Sensitivity& sensitivity, bool wrong, double accuracy, Run& run);

Json ratings_json(const landing::Ratings& ratings);
/// Warns of each, `whose` in front.
void warn_of(const std::vector<std::string>& doubts, Run& run, const std::string& whose = "");

/// Warns where an answer lies on the edge of what was searched.
void warn_of_edges(const std::vector<landing::Variable>& variables, const landing::Edges& edges, Run& run);

/// A column of a trajectory over time, in `unit`s.
Series curve(const std::string& name, const std::vector<landing::Sample>& trajectory, double landing::Sample::*column,
             double unit = 1);
/// The smallest peak of a map over the variables that are not drawn.
Heatmap projection(const landing::PeakMap& map, int x, int y);
/// Where the floor's constants come from, if the scene says so.
void floor_source(Report& report, const std::string& source);
/// What was simulated, as numbers.
void constants_table(Report& report, const landing::Scene& scene, const Actuator& actuator);

}  // namespace ukemi::tools

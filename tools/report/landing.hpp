// Quantities of motions and landings in reports, defined once for all verbs.
#pragma once

#include <functional>
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

inline constexpr std::array<const char*, 2> kGoalNames = {"peak", "tolerant"};  ///< by landing::Goal

/// A peak in words: "not played" for NaN, "not to be followed" for infinity.
std::string peak_words(double peak);
std::string short_peak_words(double peak);  ///< to 4 digits
std::string percent_words(double fraction);

/// A variable as reports and files show it: angles in degrees.
struct Display {
  double factor;
  std::string key;    ///< "phi_i_deg", or with a middle "phi_i_down_deg"
  std::string words;  ///< "phi_I [deg]"
};
Display display(const landing::Variable& variable, const std::string& middle = "");

/// How reports name what a kind of robot has.
struct RobotWords {
  std::string acceleration;  ///< of the peak: "|ddr_0|", "|a|"
  const char* contact;       ///< what touches the floor: "point", "contact"
  PointName point;           ///< of Touch::point and Peak::point
};
RobotWords words_of(const landing::TwoLink<double>& robot);
/// `robot` must outlive the words.
RobotWords words_of(const landing::Robot& robot);

Quantities<landing::Motion> motion_quantities(const landing::Motion& like);
Quantities<landing::Touch> contact_quantities(const RobotWords& words);
/// The worst peaks under one deviation each.
Quantities<landing::Evidence> deviation_quantities();
/// Width of the motion's basin in each variable, the tolerant peak under the heading `tolerant_peak` (empty: in files
/// only), the deviations.
Quantities<landing::Evidence> evidence_quantities(const std::vector<landing::Variable>& variables,
                                                  const std::string& tolerant_peak);

Json motion_json(const landing::Motion& motion);
/// A motion on one line.
std::string motion_words(const landing::Motion& motion);
/// The same, called as of robots of links.
inline Json motion_json(const landing::TwoLink<double>&, const landing::Motion& motion) { return motion_json(motion); }
inline std::string motion_words(const landing::TwoLink<double>&, const landing::Motion& motion) {
  return motion_words(motion);
}
/// "foot, knee, hip": the points in the order of their touchdowns; chatter left out.
std::string contact_order(const landing::ContactOrder& contacts, const PointName& name = point_name);
/// Why there is no landing; `point`: what touches the floor, "point" or "contact".
std::string failure_words(const landing::RunEnd& run, const char* point = "point");

/// Warns of a run that failed, met no floor or could not be checked.
void warn_of(const landing::RunEnd& run, const landing::Sensitivity& sensitivity, const char* point, Run& to);
/// Warns of a peak that is `wrong`, see CheckedLanding, or sensitive; `accuracy`: the requested one.
void warn_of(const landing::Sensitivity& sensitivity, bool wrong, double accuracy, Run& run);

Json ratings_json(const landing::Ratings& ratings);
/// Warns of each doubt with the prefix `whose`.
void warn_of(const std::vector<std::string>& doubts, Run& run, const std::string& whose = "");

/// Warns of variables on an edge of their search range.
void warn_of_edges(const std::vector<landing::Variable>& variables, const landing::Edges& edges, Run& run);

/// A quantity of a trajectory over time, multiplied by `unit`; `of`: a function or a member of a row.
template <class Row, class Of>
Series curve(const std::string& name, const std::vector<Row>& trajectory, Of of, double unit = 1) {
  Series out{name, {}, {}};
  for (const Row& s : trajectory) out.x.push_back(s.t), out.y.push_back(std::invoke(of, s) * unit);
  return out;
}
/// Heat map over variables x and y: the smallest peak over all others.
Heatmap projection(const landing::PeakMap& map, int x, int y);
/// Adds where the floor's constants come from, if the scene says so.
void floor_source(Report& report, const std::string& source);
inline const std::string& source_of(const landing::Scene& scene) { return scene.floor_source; }
inline const std::string& source_of(const landing::BodyScene& scene) { return scene.source; }
/// Adds the constants of scene and actuator.
void constants_table(Report& report, const landing::Scene& scene, const Actuator& actuator);

}  // namespace ukemi::tools

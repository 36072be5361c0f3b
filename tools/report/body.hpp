// Robots of any joints and their landings as a reader sees them: tables, the drawing, the animation, the figures.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "landing/plan/body_least_breaking.hpp"
#include "landing/plan/body_map.hpp"
#include "landing/plan/body_plan.hpp"
#include "landing/plan/body_risk.hpp"
#include "landing/plan/checked_body.hpp"
#include "tools/report/exports.hpp"
#include "tools/report/landing.hpp"
#include "tools/report/report.hpp"
#include "tools/report/trajectory.hpp"
#include "tools/study/body_comparison.hpp"

namespace ukemi::tools {

extern const Outputs kRobotOutputs;

/// One of the landings that stand side by side.
struct BodyFall {
  std::string name;  ///< "held"
  const landing::BodyLanding* landing;
};
/// The animation and the figures; falls without a trajectory are left out. `data`: the CSV that holds the numbers.
void show(const landing::BodyScene& scene, std::vector<BodyFall> falls, const std::string& data, Report& report);
/// The robot as it is released, every driven joint held where its scene says.
Figure drawing(const landing::BodyScene& scene);

RowColumns<landing::BodySample> trajectory_columns(const landing::Robot& robot);
std::string trajectory_csv(const landing::BodyScene& scene, const landing::BodyLanding& landing, const Run& run);
/// Of the robot's contacts; it must outlive them.
Quantities<landing::Touch> contact_quantities(const landing::Robot& robot);
/// phi_i_JOINT_deg ..., in JSON JOINT.phi_i_deg.
Quantities<landing::BodyMotion> motion_quantities(const landing::Robot& robot, const landing::BodyMotion& like);
/// "hip 35, knee -70 deg" of a posture, or where each joint goes.
std::string motion_words(const landing::Robot& robot, const landing::BodyMotion& motion);
/// What each joint and its drive stood, beside their ratings.
Json joints_json(const landing::BodyScene& scene, const landing::BodyMotion& motion,
                 const landing::BodyLanding& landing);
/// Every driven joint's speed and torque against its ratings; one that is not known is said to be so.
Check within_ratings(const landing::BodyScene& scene, const landing::BodyMotion& motion,
                     const landing::BodyLanding& landing);
/// What is planned for: "tolerant peak", "largest value / rating, peak".
std::string goal_words(const landing::BodyScene& scene, const landing::BodyPlanOptions& options);
/// The share of fresh drops in which a plan breaks no limit; absent where none were played.
std::optional<double> kept_share(const landing::BodyPlan& plan);
/// Of what a plan of the scene makes small: "m/s^2", or of loads "of the rating".
std::string unit_of(const landing::BodyScene& scene);
/// How a load is passed: "touches", "leaves its range", "is beyond 12 Nm".
std::string beyond_words(const landing::Load& load);
/// What each load of the scene came to, for a summary; told to the terminal and a report where there is one, which
/// warns of limits that do not hold. `whose`: "", ", held".
Json report_loads(const landing::BodyScene& scene, const landing::BodyLanding& landing, const std::string& whose,
                  Report* report, Run& run);
/// Links, joints and contacts as tables.
void robot_tables(const landing::BodyScene& scene, Report& report);

/// Each returns the exit code. `held`: the landing of the held posture on the same drop, to stand beside it.
int report(const landing::CheckedBody& checked, const std::optional<landing::BodyLanding>& held, const Exports& exports,
           Run& run);
/// What a plan is told beside.
struct PlanBeside {
  std::optional<landing::BodyLeastBreaking> least = {};  ///< where no motion keeps the limits
  std::vector<double> logged = {};                       ///< of each logged trial the largest acceleration [m/s^2]
};
/// `rate`: rows of motion.csv a second [Hz].
int report(const landing::BodyScene& scene, const landing::BodyPlan& plan, const landing::BodyPlanOptions& options,
           double rate, const Exports& exports, Run& run, const PlanBeside& beside = {});
int report(const landing::BodyScene& scene, const landing::BodyMotion& motion, const landing::BodyRisk& risk,
           const landing::BodyRiskOptions& options, Run& run);
/// `names`: what each set is, as its options have it.
int report(const BodyComparison& comparison, const OfSets<std::string>& names, Run& run);
int report(const landing::BodySurvey& survey, Run& run);
/// What became of a part of a robot's description: "locked", "hip_roll", why.
struct DescriptionNote {
  std::string what, name, text;
};
/// `notes`: of a robot that was made from a description, else none.
int report_robot(const landing::BodyScene& scene, const std::vector<DescriptionNote>& notes, Run& run);

}  // namespace ukemi::tools

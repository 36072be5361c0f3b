// Reports of robots of links and their landings: tables, drawing, animation, figures.
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
#include "tools/report/fall.hpp"
#include "tools/report/landing.hpp"
#include "tools/report/report.hpp"
#include "tools/report/trajectory.hpp"
#include "tools/study/body_comparison.hpp"

namespace ukemi::tools {

extern const Outputs kRobotOutputs;

/// phi_i_JOINT_deg ... in CSV, JOINT.phi_i_deg in JSON; `like`: a motion that tells which terms are in use.
Quantities<landing::BodyMotion> motion_quantities(const landing::Robot& robot, const landing::BodyMotion& like);
Json motion_json(const landing::Robot& robot, const landing::BodyMotion& motion);
/// "hip 35, knee -70 deg" of a posture, else "hip 35 to 50 deg in 0.1 s, ...".
std::string motion_words(const landing::Robot& robot, const landing::BodyMotion& motion);
/// Largest demands on each joint and its drive, with their ratings.
Json joints_json(const landing::BodyScene& scene, const landing::BodyMotion& motion,
                 const landing::BodyLanding& landing);
/// Every driven joint's speed and torque against its ratings; kUnknown where a rating is not given.
Check within_ratings(const landing::BodyScene& scene, const landing::BodyMotion& motion,
                     const landing::BodyLanding& landing);
/// The goal of a plan: "tolerant peak", "largest value / rating, peak".
std::string goal_words(const landing::BodyScene& scene, const landing::BodyPlanOptions& options);
/// Share of fresh drops in which a plan keeps every limit; absent where none were played.
std::optional<double> kept_share(const landing::BodyPlan& plan);
/// Unit of the goal: "m/s^2", or "of the rating" for a scene with loads.
std::string unit_of(const landing::BodyScene& scene);
/// How a load exceeds its rating: "touches", "leaves its range", "is beyond 12 Nm".
std::string exceeded_words(const landing::Load& load);
/// JSON of the largest value of each load. With a `report` also prints and shows them and warns of broken limits.
/// `whose`: suffix of the heading, "" or ", held".
Json report_loads(const landing::BodyScene& scene, const landing::BodyLanding& landing, const std::string& whose,
                  Report* report, Run& run);
/// Adds links, joints, contacts and stops as tables.
void robot_tables(const landing::BodyScene& scene, Report& report);

/// Each returns the exit code. `held`: landing of the held posture on the same drop, for comparison.
int report(const landing::CheckedBody& checked, const std::optional<landing::BodyLanding>& held, const Exports& exports,
           Run& run);
/// What the report of a plan shows in addition.
struct PlanExtras {
  std::optional<landing::BodyLeastBreaking> least = {};  ///< where no motion keeps the limits
  std::vector<double> logged = {};                       ///< largest simulated acceleration of each trial [m/s^2]
};
/// `rate`: rows of motion.csv per second [Hz].
int report(const landing::BodyScene& scene, const landing::BodyPlan& plan, const landing::BodyPlanOptions& options,
           double rate, const Exports& exports, Run& run, const PlanExtras& extras = {});
int report(const landing::BodyScene& scene, const landing::BodyMotion& motion, const landing::BodyRisk& risk,
           const landing::BodyRiskOptions& options, Run& run);
/// `names`: of the two sets of constants.
int report(const BodyComparison& comparison, const PerSet<std::string>& names, Run& run);
int report(const landing::BodySurvey& survey, Run& run);
/// How a part of a robot's description was converted: "locked", "hip_roll", why.
struct DescriptionNote {
  std::string what, name, text;
};
/// `notes`: empty unless the robot was made from a description (URDF, MJCF).
int report_robot(const landing::BodyScene& scene, const std::vector<DescriptionNote>& notes, Run& run);

}  // namespace ukemi::tools

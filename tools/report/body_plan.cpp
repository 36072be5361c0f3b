#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tools/report/body.hpp"
#include "tools/report/landing.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

Quantities<BodyPlan> plan_quantities(const BodyScene& scene, const BodyPlan& plan) {
  Quantities<BodyPlan> out;
  append(out, "motion/", motion_quantities(scene.robot, plan.motion), [](const BodyPlan& p) { return p.motion; });
  const Robot& robot = scene.robot;
  out.insert(
      out.end(),
      {{"", "peak_acceleration", "peak |a| [m/s^2]", peak_words, [](auto& p) { return p.landing.peak; }},
       {"", "peak_time", [](auto& p) { return p.landing.t_peak; }},
       {"", "hold/peak_acceleration", "held: " + motion_words(robot, plan.hold) + " [m/s^2]", peak_words,
        [](auto& p) { return p.held.peak; }},
       {"", "hold/peak", [](auto& p) { return p.held.peak; }},
       {"", "reduction", "reduction", percent_words, [](auto& p) { return 1 - p.landing.peak / p.held.peak; }},
       {"", "", "contacts", {}, [&robot](auto& p) { return contact_order(p.landing.peaks, contact_name(robot)); }},
       {"", "evaluations", "motions evaluated", {}, &BodyPlan::evaluations}});
  for (std::size_t i = 0; i < robot.joints.size(); ++i)
    if (robot.joints[i].driven())
      out.push_back({"", "hold/phi_deg/" + robot.joints[i].name, [i](auto& p) { return p.hold[i].phi_i * kDegrees; }});
  return out;
}

std::string progress_csv(const Run& run, const BodyPlan& plan) {
  CsvWriter csv = run.csv();
  csv.header({"evaluations", "time_s", "best"});
  for (const BodyProgress& p : plan.progress) csv.cell(p.evaluations).cell(p.seconds).cell(p.value).end_row();
  return csv.text();
}

Series descent(const BodyPlan& plan) {
  Series out{"best so far", {}, {}};
  for (const BodyProgress& p : plan.progress) {
    if (!out.x.empty()) out.x.push_back(double(p.evaluations)), out.y.push_back(out.y.back());
    out.x.push_back(double(p.evaluations)), out.y.push_back(p.value);
  }
  if (!out.x.empty()) out.x.push_back(double(plan.evaluations)), out.y.push_back(out.y.back());
  return out;
}

}  // namespace

int report(const BodyScene& scene, const BodyPlan& plan, const BodyPlanOptions& options, double rate, Run& run) {
  constexpr double kShort = 2;  // gnuplot takes some 0.1 s: a short deadline is for the search [s]
  const Robot& robot = scene.robot;
  if (!plan.message.empty()) run.warn(plan.message);
  warn_of_edges(plan.variables, plan.edges, run);
  Json summary;
  if (plan.found) {
    const Table table = Table::of(plan_quantities(scene, plan), plan);
    summary = table.object();
    summary["peaks"] = peaks_json(plan.landing.peaks, contact_name(robot));
    summary["contacts"] = Table(contact_quantities(robot), plan.landing.touches).objects();
    summary["joints"] = joints_json(scene, plan.motion, plan.landing, run);
    say(table.turned(), run);
    run.say(fmt::format("searched for {:.2f} s", plan.seconds));
    run.add("motion.toml", body_motion_toml(plan.motion, robot, run.provenance_text()));
    run.add("motion.csv", body_motion_csv(plan.motion, robot, rate, run.provenance_text()));
    run.add("progress.csv", progress_csv(run, plan));
    Report report("Best landing: " + scene.name);
    report.table(table.turned());
    report.distrust(run.warnings());
    const bool drawn = !options.deadline || *options.deadline >= kShort;
    if (drawn) {
      show(scene, {{"best motion", &plan.landing}, {"held", &plan.held}}, "", report);
      report.heading("The search");
      report.plot("search", "motions evaluated", "best peak [m/s²]", {descent(plan)}, Axes::kLogarithmic);
    } else {
      report.paragraph(
          "The fall is not shown, for the deadline leaves no time to draw it: `ukemi simulate --motion motion.toml` "
          "does.");
    }
    robot_tables(scene, report);
    report.write(run);
  } else {
    summary = {{"motion", nullptr}, {"evaluations", plan.evaluations}};
  }
  summary["solver"] = "auto", summary["objective"] = "peak", summary["seed"] = options.seed;
  return run.finish(summary, plan.found ? kDone : kNumbers);
}

}  // namespace ukemi::tools

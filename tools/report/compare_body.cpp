#include "landing/body/load.hpp"
#include "tools/report/body.hpp"
#include "tools/report/compare.hpp"
#include "tools/report/landing_doubts.hpp"
#include "tools/report/scatter.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

std::string trajectories_csv(const BodyComparison& c, const Run& run) {
  CsvWriter csv = run.csv();
  csv.comment("Each set's best motion with its own drives. t = 0 at release. Units: s, m/s^2, rad.");
  const std::vector<Joint>& joints = c.scenes[0].robot.joints;
  std::vector<std::string> names = {"set", "t", "acc"};
  for (const Joint& j : joints)
    if (j.driven()) names.insert(names.end(), {"phi_" + j.name, "phi_ref_" + j.name});
  csv.header(names);
  for (std::size_t s = 0; s < 2; ++s)
    for (const BodySample& x : c.motions[s].landings[s]->trajectory) {
      csv.cell(kSets[s]).cell(x.t).cell(x.acc);
      for (std::size_t j = 0; j < joints.size(); ++j)
        if (joints[j].driven()) csv.cell(x.phi[j]).cell(x.phi_ref[j]);
      csv.end_row();
    }
  return csv.text();
}

ComparisonTexts texts_of(const BodyComparison& c) {
  const BodyScene& scene = c.scenes[1];
  const Robot& robot = scene.robot;
  ComparisonTexts out{.scene = scene.name,
                      .source = scene.source,
                      .peak = "|a|",
                      .truth = "the robot with the identified ones",
                      .motions = motion_texts(
                          c.motions, [&](const BodyMotion& m) { return motion_words(robot, m); },
                          [&](const BodyMotion& m) { return Table::of(motion_quantities(robot, m), m).object(); },
                          [&](std::size_t set, const BodyLanding& l) { return worth(c.scenes[set], l); }),
                      .landed = c.landed(),
                      .rated = rated(scene)};
  for (const ComparedBodyPlan& p : c.plans)
    out.plans.push_back({p.set, motion_words(robot, p.best.motion), p.best.value, p.truth});
  return out;
}

}  // namespace

int report(const BodyComparison& c, const PerSet<std::string>& names, Run& run) {
  const auto doubts = [&](std::size_t set, const BodyMotion& motion, const BodyLanding& l) {
    return landing_doubts(c.scenes[set], motion, l);
  };
  warn_of_motions(c.motions, "contact", doubts, run);
  const ComparisonTexts texts = texts_of(c);
  warn_of_short_search(texts, run);
  Report report = comparison_page(names, run);
  Json summary;
  report_constants(c.constants, summary, report, run);
  report_motions(texts, summary, report, run);
  if (c.landed()) {
    run.add("trajectories.csv", trajectories_csv(c, run));
    show(c.scenes[1],
         {{"planned with the identified constants", &*c.motions[1].landings[1]},
          {"planned with the nominal constants", &*c.motions[0].landings[1]}},
         "trajectories.csv holds each motion with its own drives", report);
    report.paragraph("Both falls above are with the identified constants, which stand for the real robot.");
  }
  robot_tables(c.scenes[1], report);
  report.write(run);
  return run.finish(summary, c.complete ? kDone : kNumbers);
}

}  // namespace ukemi::tools

#include <fmt/format.h>

#include <cmath>

#include "landing/judge/checked.hpp"
#include "landing/judge/under_scatter.hpp"
#include "tools/report/exports.hpp"
#include "tools/report/fall.hpp"
#include "tools/report/landing.hpp"
#include "tools/report/landing_doubts.hpp"
#include "tools/report/results.hpp"
#include "tools/report/trajectory.hpp"

namespace ukemi::tools {

const Outputs kSimulateOutputs = Outputs{
    "simulate",
    {"trajectory.csv", "contacts.csv", "motion_ros2.yaml", "reposition_ros2.yaml", "plotjuggler.csv", "set_scene.toml",
     "set_robot.toml"}}.with(fall_figures());

using namespace landing;

namespace {

const Quantities<CheckedLanding> kQuantities = checked_quantities<CheckedLanding>(
    "|ddr_0|", [](auto&) { return PointName(point_name); },
    {{"",
      "",
      "sensitive",
      {},
      [](auto& c) { return !c.sensitivity.checked    ? "not checked"
                           : c.sensitivity.sensitive ? "yes"
                                                     : "no"; }},
     {"", "joint_lost", [](auto& c) { return c.landing.joint_lost; }}});

/// "held at -45 deg", "from -45 to -60 deg in 0.1 s".
std::string motion_name(const Motion& m) {
  if (!moves(m)) return fmt::format("held at {:.4g} deg", m.phi_i * kDegrees);
  return fmt::format("from {:.4g} to {:.4g} deg in {:.4g} s", m.phi_i * kDegrees, m.phi_f * kDegrees, m.duration);
}

FirstScreen first_screen(const CheckedLanding& c, const std::optional<Landing>& held) {
  const bool followed = c.landing.end != End::kFailed;
  return {followed ? landing_sentence(c.landing.peak, held ? held->peak : std::nan(""))
                   : "The landing could not be followed to its end.",
          {converged(c.sensitivity, c.wrong()), within_ratings(c.ratings),
           check(!c.landing.joint_lost, "the drive keeps the joint", "")},
          "`ukemi optimize` searches for a softer landing."};
}

void warn(const CheckedLanding& c, Run& run) {
  const Landing& l = c.landing;
  warn_of(landing_doubts(c.instability, c.ratings.tau_max), run);
  warn_of(l, c.sensitivity, "point", run);
  warn_of(landing_doubts(l), run);
  if (const auto& stops = c.scene.joint; stops && (l.demands.phi_min < (*stops)[0] || l.demands.phi_max > (*stops)[1]))
    run.warn(fmt::format(
        "the joint leaves its stops: it moves from {:.4g} to {:.4g} deg, the stops are at {:.4g} and {:.4g}",
        l.demands.phi_min * kDegrees, l.demands.phi_max * kDegrees, (*stops)[0] * kDegrees, (*stops)[1] * kDegrees));
  warn_of(c.sensitivity, c.wrong(), c.accuracy, run);
  warn_of(landing_doubts(c.ratings), run);
}

}  // namespace

int report(const CheckedLanding& c, const Actuator& actuator, const std::optional<Landing>& held,
           const Exports& exports, Run& run) {
  const Landing& l = c.landing;
  warn(c, run);
  const Table table = Table::of(kQuantities, c), contacts(contact_quantities(), l.touches);
  Json summary = table.object();
  summary["implicit_steps"] = l.work.implicit;  // where a phase is stiff
  if (l.end == End::kFailed) summary["failed"] = failure_words(l);
  summary["motion"] = motion_json(c.motion);
  summary["peaks"] = peaks_json(l.peaks);
  summary["contacts"] = contacts.objects();
  summary["ratings"] = ratings_json(c.ratings);
  run.add("trajectory.csv", trajectory_csv(l.trajectory, run));
  run.add(
      "contacts.csv",
      contacts.csv(run, "t = 0 at release; t_liftoff: when the point rises through y = 0 again. Units: s, N, m/s^2."));
  const double start = l.contacts.first() + c.scene.detection_delay;
  for (auto& [name, content] : exported(exports, c.motion, start, l, run)) run.add(name, content);
  Report report("Landing: " + c.scene.name);
  say(table.transposed(), run);
  report.answer(first_screen(c, held), run.warnings());
  std::vector<Fall> falls = {{motion_name(c.motion), &l}};
  if (held) falls.push_back({motion_name(kHeld), &*held});
  show({c.scene, actuator, falls, {}, "trajectory.csv, contacts.csv"}, report);
  report.distrust(run.warnings());
  report.folded("All numbers", table.transposed());
  report.heading("Contacts");
  report.table(contacts);
  constants_table(report, c.scene, actuator);
  floor_source(report, c.scene.floor_source);
  report.write(run);
  return run.finish(summary, l.end == End::kFailed || c.wrong() ? kNumbers : kDone);
}

}  // namespace ukemi::tools

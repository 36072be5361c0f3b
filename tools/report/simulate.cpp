#include <fmt/format.h>

#include <cmath>

#include "landing/judge/checked.hpp"
#include "landing/judge/under_scatter.hpp"
#include "tools/report/body.hpp"
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

/// Quantities of a checked landing; `own`: of this kind of robot.
template <class Checked>
Quantities<Checked> checked_quantities(const Checked& checked_landing, const Quantities<Checked>& own) {
  const auto checked = [](auto member) {
    return [member](const Checked& c) { return c.sensitivity.checked ? Json(c.sensitivity.*member) : Json(); };
  };
  const RobotWords words = words_of(checked_landing.scene.robot);
  Quantities<Checked> out = {
      {"", "peak_acceleration", "peak " + words.acceleration + " [m/s^2]", "{:.10g}",
       [](auto& c) { return c.landing.peak; }},
      {"", "peak_time", "its time [s]", "{:.9g}", [](auto& c) { return c.landing.t_peak; }},
      {"", "error_estimate", "estimated relative error", "{:.1g}", checked(&Sensitivity::error_estimate)},
      {"", "sensitive", checked(&Sensitivity::sensitive)},
      {"", "sensitivity", checked(&Sensitivity::change)}};
  out.insert(out.end(), own.begin(), own.end());
  out.insert(out.end(),
             {{"", "joint_lost", [](auto& c) { return c.landing.joint_lost; }},
              {"", "", "contacts", {}, [=](auto& c) { return contact_order(c.landing.contacts, words.point); }},
              {"", "end", "end", {}, [](auto& c) { return name(c.landing.end); }},
              {"", "t_end", "end of the run [s]", "{:.4g}", [](auto& c) { return c.landing.t_end; }},
              {"", "energy_residual", "energy residual", "{:.1e}", [](auto& c) { return c.landing.energy_residual; }},
              {"", "steps", [](auto& c) { return c.landing.work.steps; }}});
  return out;
}

/// "held at -45 deg", "from -45 to -60 deg in 0.1 s".
std::string motion_name(const Motion& m) {
  if (!moves(m)) return fmt::format("held at {:.4g} deg", m.phi_i * kDegrees);
  return fmt::format("from {:.4g} to {:.4g} deg in {:.4g} s", m.phi_i * kDegrees, m.phi_f * kDegrees, m.duration);
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

void warn(const CheckedBody& c, Run& run) {
  warn_of(c.landing, c.sensitivity, "contact", run);
  warn_of(c.sensitivity, c.wrong(), c.accuracy, run);
  warn_of(landing_doubts(c.scene, c.motion, c.landing), run);
}

/// What a report says of one kind of robot alone.
template <class Checked, class Row>
struct LandingTexts {
  Quantities<Checked> own;  ///< see checked_quantities
  const char* liftoff;      ///< of contacts.csv: when a touch ends
  std::string words;        ///< of trajectory.csv
  RowColumns<Row> columns;
  std::pair<const char*, Json> loads;  ///< key and value of the summary: what the drives are asked for
  std::vector<Check> checks;
  std::map<std::string, std::string> exported;
  std::function<void(Report&, Json& summary)> figures;
  std::function<void(Report&)> robot;
};

/// Reports and writes a landing; `held`: peak of the held reference, NaN where it was not played.
template <class Checked, class Row>
int report_landing(const Checked& c, double held, const LandingTexts<Checked, Row>& t, Run& run) {
  const auto& l = c.landing;
  const RobotWords words = words_of(c.scene.robot);
  const bool failed = l.end == End::kFailed;
  const Table table = Table::of(checked_quantities(c, t.own), c), contacts(contact_quantities(words), l.touches);
  Json summary = table.object();
  if constexpr (std::is_same_v<Checked, CheckedLanding>)
    summary["implicit_steps"] = l.work.implicit;  // of stiff phases
  if (failed) summary["failed"] = failure_words(l, words.contact);
  summary["motion"] = motion_json(c.scene.robot, c.motion);
  summary["peaks"] = peaks_json(l.peaks, words.point);
  summary["contacts"] = contacts.objects();
  summary[t.loads.first] = t.loads.second;
  CsvWriter rows = run.csv();
  rows.comment("t = 0 at release. Two rows with one t: left and right limit of an event. " + t.words);
  run.add("trajectory.csv", rows_csv(rows, t.columns, &RowColumn<Row>::name, l.trajectory));
  run.add("contacts.csv",
          contacts.csv(run, fmt::format("t = 0 at release; t_liftoff: when the {}. Units: s, N, m/s^2.", t.liftoff)));
  for (auto& [name, content] : t.exported) run.add(name, content);
  Report report("Landing: " + c.scene.name);
  say(table.transposed(), run);
  std::vector<Check> checks = {converged(c.sensitivity, c.wrong())};
  checks.insert(checks.end(), t.checks.begin(), t.checks.end());
  report.answer({failed ? "The landing could not be followed to its end." : landing_sentence(l.peak, held), checks,
                 "`ukemi optimize` searches for a softer landing."},
                run.warnings());
  t.figures(report, summary);
  report.distrust(run.warnings());
  report.folded("All numbers", table.transposed());
  report.heading("Contacts");
  report.table(contacts);
  t.robot(report);
  report.write(run);
  return run.finish(summary, failed || c.wrong() ? kNumbers : kDone);
}

constexpr const char* kData = "trajectory.csv, contacts.csv";

}  // namespace

int report(const CheckedLanding& c, const Actuator& actuator, const std::optional<Landing>& held,
           const Exports& exports, Run& run) {
  const Landing& l = c.landing;
  warn(c, run);
  const auto sensitive = [](const auto& checked) {
    return !checked.sensitivity.checked ? "not checked" : checked.sensitivity.sensitive ? "yes" : "no";
  };
  const auto figures = [&](Report& report, Json&) {
    std::vector<Fall> falls = {{motion_name(c.motion), &l}};
    if (held) falls.push_back({motion_name(kHeld), &*held});
    show({c.scene, actuator, falls, {}, kData}, report);
  };
  const auto robot = [&](Report& report) {
    constants_table(report, c.scene, actuator);
    floor_source(report, c.scene.floor_source);
  };
  return report_landing<CheckedLanding, Sample>(
      c, held ? held->peak : std::nan(""),
      {.own = {{"", "", "sensitive", {}, sensitive}},
       .liftoff = "point rises through y = 0 again",
       .words = "Units: s, m, rad, N, Nm; acc = |ddr_0|, m/s^2.",
       .columns = trajectory_columns(),
       .loads = {"ratings", ratings_json(c.ratings)},
       .checks = {within_ratings(c.ratings), check(!l.joint_lost, "the drive keeps the joint", "")},
       .exported = exported(exports, c.motion, l.contacts.first() + c.scene.detection_delay, l, run),
       .figures = figures,
       .robot = robot},
      run);
}

int report(const CheckedBody& c, const std::optional<BodyLanding>& held, const Exports& exports, Run& run) {
  const BodyLanding& l = c.landing;
  warn(c, run);
  const auto first_touchdown = [](const auto& checked) { return number(checked.landing.contacts.first()); };
  const auto figures = [&](Report& report, Json& summary) {
    if (!c.scene.loads.empty()) summary["loads"] = report_loads(c.scene, l, "", &report, run);
    std::vector<BodyFall> falls = {{motion_words(c.scene.robot, c.motion), &l}};
    if (held) falls.push_back({"held", &*held});
    show(c.scene, falls, kData, report);
  };
  return report_landing<CheckedBody, BodySample>(
      c, held ? held->peak : std::nan(""),
      {.own = {{"", "first_touchdown", "first touchdown [s]", "{:.6f}", first_touchdown}},
       .liftoff = "contact rises through its surface again, its pad's if it has one",
       .words = "x, y, theta: each link's origin and absolute angle; acc: of the point that counts. Units: s, m, rad, "
                "N, Nm, "
                "m/s^2.",
       .columns = trajectory_columns(c.scene.robot),
       .loads = {"joints", joints_json(c.scene, c.motion, l)},
       .checks = {within_ratings(c.scene, c.motion, l)},
       .exported = exported(exports, c.scene, c.motion, l, run),
       .figures = figures,
       .robot = [&](Report& report) { robot_tables(c.scene, report); }},
      run);
}

}  // namespace ukemi::tools

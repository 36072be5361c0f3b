#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/median.hpp"
#include "landing/body/load.hpp"
#include "landing/model/scatter_file.hpp"
#include "tools/report/body.hpp"
#include "tools/report/landing.hpp"
#include "tools/report/landing_doubts.hpp"
#include "tools/report/results.hpp"
#include "tools/report/scatter.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

/// "held: hip 35, knee -70 deg".
std::string held_words(const Robot& robot, const BodyMotion& hold) { return "held: " + motion_words(robot, hold); }

Quantities<BodyPlan> plan_quantities(const BodyScene& scene, const BodyPlan& plan, const std::string& goal,
                                     bool landings) {
  Quantities<BodyPlan> out;
  append(out, "motion/", motion_quantities(scene.robot, plan.motion), [](const BodyPlan& p) { return p.motion; });
  const Robot& robot = scene.robot;
  out.insert(
      out.end(),
      {{"", "peak_acceleration", "peak |a| [m/s^2]", peak_words, [](auto& p) { return p.landing.peak; }},
       {"", "peak_time", [](auto& p) { return p.landing.t_peak; }},
       {"", "hold/peak_acceleration", held_words(robot, plan.hold) + " [m/s^2]", peak_words,
        [](auto& p) { return p.held.peak; }},
       {"", "hold/peak", [](auto& p) { return p.held.peak; }},
       {"", "reduction", "reduction", percent_words,
        [of_value = rated(scene)](auto& p) {
          return 1 - (of_value ? p.value / p.held_value : p.landing.peak / p.held.peak);
        }},
       {"", "", "contacts", {}, [&robot](auto& p) { return contact_order(p.landing.contacts, contact_name(robot)); }},
       {"", "evaluations", landings ? "landings" : "motions evaluated", {}, &BodyPlan::evaluations}});
  if (goal != "peak") {
    const std::string unit = fmt::format(" [{}]", unit_of(scene));
    out.push_back({"", "value", goal + unit, peak_words, [](auto& p) { return p.value; }});
    out.push_back({"", "hold/value", "the same, held" + unit, peak_words, [](auto& p) { return p.held_value; }});
  }
  if (goal == goal_words(Goal::kTolerant, {})) {
    out.push_back({"", "tolerant_peak", [](auto& p) { return p.value; }});
    out.push_back({"", "hold/tolerant_peak", [](auto& p) { return p.held_value; }});
  }
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

Json scatter_json(const BodyUnderScatter& u) {
  return {{"deviations", u.scatter ? Json(text_of(*u.scatter)) : Json()},
          {"assumed", u.assumed},
          {"planned", distribution_json(u.planned)},
          {"held", distribution_json(u.held)},
          {"measured", number(u.measured.value)},
          {"measured_std", number(u.measured.standard_error)},
          {"from_floor", u.from_floor},
          {"broken", u.broken}};
}

const char* drops_noun(const BodyUnderScatter& u) { return u.scatter ? "fresh drops" : "measured drops"; }

/// Whether the share of fresh drops that was asked for, or all, keep the limits.
Check share_check(const BodyPlan& p, const BodyPlanOptions& options) {
  if (const std::optional<double> kept = kept_share(p))
    return keeps_limits_check(*kept, p.under->planned.samples, drops_noun(*p.under), options.share);
  return {Check::State::kUnknown, "keeps its limits under scatter",
          fmt::format("the share that keeps the limits is not judged on fresh drops{}; asked {:g} %",
                      options.deadline ? ": the deadline left no time" : "", 100 * *options.share)};
}

/// Reports in how many fresh drops each load exceeds its rating.
Json report_exceeded(const BodyScene& scene, const BodyUnderScatter& u, Report& report, Run& run) {
  Json out = Json::object();
  const auto share = [&](long drops) { return double(drops) / double(u.planned.samples); };
  for (std::size_t i = 0; i < u.exceeded.size(); ++i) {
    const Load& l = scene.loads[i];
    out[l.name] = {{"drops", u.exceeded[i]}, {"share", share(u.exceeded[i])}};
    const std::string words = fmt::format("{}: {} in {} of {}", l.name, exceeded_words(l),
                                          percent_words(share(u.exceeded[i])), drops_noun(u));
    run.say(words), report.paragraph(words + ".");
  }
  return out;
}

FirstScreen first_screen(const BodyScene& scene, const BodyPlan& p, const BodyPlanOptions& options,
                         const std::vector<double>& logged) {
  FirstScreen out{.sentence =
                      rated(scene)
                          ? fmt::format("The largest load is {:.2g} of its rating, where holding still has {:.2g}.",
                                        p.value, p.held_value)
                          : landing_sentence(p.landing.peak, p.held.peak)};
  if (logged.size() == 1)
    out.sentence += fmt::format(" In its log the model took {:.4g} m/s^2.", logged[0]);
  else if (!logged.empty())
    out.sentence += fmt::format(" In its {} logged trials the model took {:.4g} (median), at most {:.4g} m/s^2.",
                                logged.size(), median(logged), *std::max_element(logged.begin(), logged.end()));
  if (scene.limited())
    out.checks.push_back(
        check(!p.landing.broken, "keeps its limits in its own drop", p.held_keeps_limits ? "" : "holding breaks them"));
  const bool inside = std::all_of(p.edges.begin(), p.edges.end(), [](auto e) { return e == 0; });
  out.checks.push_back({inside ? Check::State::kGood : Check::State::kCaution, "inside the search range",
                        inside ? "" : "on an edge: beyond it may be better"});
  out.checks.push_back(within_ratings(scene, p.motion, p.landing));
  if (p.under) {
    const BodyUnderScatter& u = *p.under;
    out.sentence += fmt::format(" In the worst tenth of drops {:.4g}.", u.planned.cvar90.value);
    out.checks.push_back(under_scatter_check(u.planned.cvar90.value, u.held.cvar90.value, rated(scene)));
  } else {
    if (options.measure) out.sentence += promised_words(options.measure->name(), p.value);
    out.checks.push_back({Check::State::kUnknown, "holds under scatter", "not played"});
  }
  if (options.share || (p.under && scene.limited())) out.checks.push_back(share_check(p, options));
  out.next = "`ukemi risk` with --motion motion.toml plays it over many drops.";
  return out;
}

/// Reports the plan and the held posture over fresh drops, and the promised value against the fresh one.
void report_scatter(const BodyPlan& p, const BodyPlanOptions& options, const std::string& held, bool rated,
                    Report& report, Run& run) {
  const BodyUnderScatter& u = *p.under;
  const std::string drops = scatter_words(u.scatter, u.assumed), noun = drops_noun(u);
  run.say(fmt::format("under scatter ({}; {} {}): {}; {}: {}", drops, u.planned.samples, noun,
                      distribution_words(u.planned), held, distribution_words(u.held)));
  if (options.measure)
    run.say(fmt::format("promised {}, over {} {}{} ({:+.1f} %)", short_peak_words(p.value), noun,
                        short_peak_words(u.measured.value), band_words(u.measured),
                        100 * (u.measured.value / p.value - 1)));
  if (u.broken > 0)
    run.warn(fmt::format("the plan breaks a limit in {} of {} {} ({:.2g} %)", u.broken, u.planned.samples, noun,
                         100.0 * double(u.broken) / double(u.planned.samples)));
  warn_of_floor(u.from_floor, u.planned.samples, run);
  if (u.planned.cvar90.value > u.held.cvar90.value)
    run.warn(fmt::format("in the worst tenth of scattered drops the motion's {}, {} {}: doing nothing is safer{}",
                         (rated ? "value / rating is " : "peak is ") + short_peak_words(u.planned.cvar90.value) +
                             (rated ? "" : " m/s^2"),
                         held, short_peak_words(u.held.cvar90.value),
                         options.measure ? "" : "; --robust cvar plans for that"));
  report.heading("Under scatter");
  report.paragraph(fmt::format("Drops: {}. The same {} for both{}.", drops, u.planned.samples,
                               u.scatter ? "; they are others than those that were searched on" : ""));
  report.table(Table(named_quantities(distributed_words("|a|", rated)), {{"planned", u.planned}, {held, u.held}}));
}

/// Reports the motion with the smallest violation of the limits, where none keeps them.
void report_least_breaking(const Robot& robot, const BodyLeastBreaking& l, Run& run, Json& summary) {
  const Load& limit = l.limit;
  const std::string of = place_of(limit, robot);
  summary["least_breaking"] = {{"load", limit.name},       {"rating", name(limit.kind)}, {"of", of},
                               {"unit", unit(limit.kind)}, {"demand", l.demand},         {"limit", limit.rating},
                               {"motion", Json::object()}};
  for (std::size_t i = 0; i < robot.joints.size(); ++i)
    if (robot.joints[i].driven()) summary["least_breaking"]["motion"][robot.joints[i].name] = motion_json(l.motion[i]);
  run.warn(fmt::format(
      "the motion that breaks them least: {}; the {} of {} is {:.4g} {}, {:.3g} times the {:.4g} allowed",
      motion_words(robot, l.motion), words(limit.kind), of, l.demand, unit(limit.kind), l.excess(), limit.rating));
}

}  // namespace

std::string goal_words(const BodyScene& scene, const BodyPlanOptions& options) {
  return (rated(scene) ? "largest value / rating, " : "") + goal_words(options.goal, options.measure);
}
std::optional<double> kept_share(const BodyPlan& plan) {
  if (!plan.under) return std::nullopt;
  return 1 - double(plan.under->broken) / double(plan.under->planned.samples);
}
std::string unit_of(const BodyScene& scene) { return goal_unit(rated(scene)); }

namespace {

void write_files(const BodyScene& scene, const BodyPlan& plan, double rate, const Exports& exports, Run& run) {
  const Robot& robot = scene.robot;
  run.add("motion.toml", body_motion_toml(plan.motion, robot, run.provenance_text()));
  run.add("motion.csv",
          body_motion_csv(plan.motion, robot, rate, run.provenance_text(), expected_start(scene, plan.landing)));
  for (auto& [name, content] : exported(exports, scene, plan.motion, plan.landing, run)) run.add(name, content);
  if (exports.has(Exports::Format::kPlotJuggler) && plan.landing.trajectory.empty())
    run.warn("plotjuggler.csv is not written: the deadline leaves no time for the landing's rows");
  run.add("progress.csv", progress_csv(run, plan));
}

/// Files, report and terminal of a plan that was found; its summary.
Json report_found(const BodyScene& scene, const BodyPlan& plan, const BodyPlanOptions& options, double rate,
                  const Exports& exports, Run& run, const PlanExtras& extras) {
  const Robot& robot = scene.robot;
  const std::string goal = goal_words(scene, options);
  warn_of(landing_doubts(scene, plan.motion, plan.landing), run);
  if (options.measure && !options.scatter && !scene.scatter) warn_of_assumed(assumed_scatter(scene.robot), run);
  const Table table = Table::of(plan_quantities(scene, plan, goal, options.measure.has_value()), plan);
  Json summary = table.object();
  summary["peaks"] = peaks_json(plan.landing.peaks, contact_name(robot));
  summary["contacts"] = Table(contact_quantities(words_of(robot)), plan.landing.touches).objects();
  summary["joints"] = joints_json(scene, plan.motion, plan.landing);
  if (!extras.logged.empty())
    summary["logged"] = {{"peak_acceleration", extras.logged}, {"median", median(extras.logged)}};
  const std::string contacts = contact_order(plan.landing.contacts, contact_name(robot));
  const bool held = std::none_of(plan.motion.begin(), plan.motion.end(), [](const Motion& m) { return moves(m); });
  say(first_screen(scene, plan, options, extras.logged),
      {(held ? "motion: none, held at " : "motion: ") + motion_words(robot, plan.motion),
       contacts.empty() ? "no contact" : "contacts: " + contacts},
      table.transposed(), run);
  run.say(fmt::format("searched for {:.2f} s", plan.seconds));
  write_files(scene, plan, rate, exports, run);
  Report report("Best landing: " + scene.name);
  const bool drawn = tools::drawn(options.deadline);
  if (drawn) show(scene, {{"best motion", &plan.landing}, {"held", &plan.held}}, "", report);
  if (!scene.loads.empty()) {
    summary["loads"] = report_loads(scene, plan.landing, "", &report, run);
    summary["hold"]["loads"] = report_loads(scene, plan.held, "", nullptr, run);
  }
  if (plan.under) {
    summary["scatter"] = scatter_json(*plan.under);
    report_scatter(plan, options, held_words(robot, plan.hold), rated(scene), report, run);
    if (!scene.loads.empty()) summary["scatter"]["loads"] = report_exceeded(scene, *plan.under, report, run);
  }
  if (options.share) run.say(share_check(plan, options).words);
  report.distrust(run.warnings());
  report.answer(first_screen(scene, plan, options, extras.logged), run.warnings());
  report.folded("All numbers", table.transposed());
  if (drawn) {
    report.heading("The search");
    report.plot("search", "motions evaluated", fmt::format("{} [{}]", goal, unit_of(scene)), {descent(plan)},
                Axes::kLogarithmic);
  } else {
    report.paragraph(kNotDrawn);
  }
  robot_tables(scene, report);
  report.write(run);
  return summary;
}

}  // namespace

int report(const BodyScene& scene, const BodyPlan& plan, const BodyPlanOptions& options, double rate,
           const Exports& exports, Run& run, const PlanExtras& extras) {
  if (!plan.message.empty()) run.warn(plan.message);
  if (plan.found && !plan.held_keeps_limits) run.warn("holding breaks the limits: it is no answer");
  warn_of_edges(plan.variables, plan.edges, run);
  Json summary;
  if (plan.found) {
    summary = report_found(scene, plan, options, rate, exports, run, extras);
  } else {
    summary = {{"motion", nullptr}, {"evaluations", plan.evaluations}};
    if (extras.least) report_least_breaking(scene.robot, *extras.least, run, summary);
  }
  summary["solver"] = options.solver, summary["objective"] = kGoalNames[std::size_t(options.goal)],
  summary["seed"] = options.seed;
  if (options.measure)
    summary["robust"] = {
        {"measure", options.measure->name()}, {"promised", number(plan.value)}, {"samples", options.samples}};
  if (options.share) {
    const std::optional<double> kept = kept_share(plan);
    summary["robust"]["share"] = *options.share, summary["robust"]["share_kept"] = kept ? Json(*kept) : Json();
  }
  return run.finish(summary, plan.found ? kDone : kNumbers);
}

}  // namespace ukemi::tools

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/degrees.hpp"
#include "landing/judge/answer.hpp"
#include "landing/judge/map.hpp"
#include "landing/model/motion_csv.hpp"
#include "landing/model/scene_file.hpp"
#include "tools/program/interrupt.hpp"
#include "tools/report/exports.hpp"
#include "tools/report/fall.hpp"
#include "tools/report/landing.hpp"
#include "tools/report/landing_doubts.hpp"
#include "tools/report/results.hpp"
#include "tools/report/scatter.hpp"

namespace ukemi::tools {

const Outputs kOptimizeOutputs = Outputs{
    "optimize",
    {"motion.toml", "motion.csv", "solvers.csv", "progress.csv", "motion_ros2.yaml", "reposition_ros2.yaml",
     "plotjuggler.csv", "set_scene.toml", "set_robot.toml"},
    {"search", "histogram",
     "deviations"}}.with(fall_figures());

using namespace landing;

namespace {

double held_degrees(const Answer& a) { return a.best.held->motion.phi_i * kDegrees; }
std::string held_words(const Answer& a) { return fmt::format("held at {:.1f} deg", held_degrees(a)); }

Quantities<Answer> answer_quantities(const Answer& answer) {
  const ExecutionTolerance& box = answer.scene.execution;
  const std::string within = fmt::format("within {:g} deg, {:g} ms [m/s^2]", box.phi * kDegrees, box.duration * 1e3);
  const ReferenceSpace space(answer.scene, answer.actuator.sea);
  Quantities<Answer> out;
  append(out, "motion/", motion_quantities(answer.best.motion), [](const Answer& a) { return a.best.motion; });
  out.insert(out.end(),
             {
                 {"", "peak_acceleration", "peak |ddr_0| [m/s^2]", peak_words, &Answer::peak},
                 {"", "tolerant_peak", "tolerant peak, " + within, peak_words,
                  [](auto& a) { return a.tolerant_known ? Json(a.best.tolerant.value) : Json(); }},
                 {"", "hold/phi_deg", held_degrees},
                 {"", "hold/peak_acceleration", held_words(answer) + " [m/s^2]", peak_words, &Answer::held_peak},
                 {"", "hold/peak", &Answer::held_peak},
                 {"", "hold/tolerant_peak", [](auto& a) { return number(a.best.held->tolerant); }},
                 {"", "hold/within_limits", [](auto& a) { return a.best.held->value < kNoMotion; }},
                 {"", "reduction", "reduction", percent_words, &Answer::reduction},
             });
  if (answer.evidence)
    append(out, "evidence/", evidence_quantities(space.variables(), ""), [](const Answer& a) { return *a.evidence; });
  if (answer.limit) {
    out.push_back({"", "limit/jump", "limit: smallest jump at the first touchdown [m/s^2]", peak_words,
                   [](auto& a) { return a.limit->jump; }});
    out.push_back({"", "limit/jump_phi_deg", [](auto& a) { return a.limit->jump_phi * kDegrees; }});
    out.push_back({"", "limit/first_contact", "smallest peak of its first 20 ms, joint held [m/s^2]", peak_words,
                   [](auto& a) { return a.limit->first_contact; }});
    out.push_back({"", "limit/first_contact_phi_deg", [](auto& a) { return a.limit->first_contact_phi * kDegrees; }});
  }
  out.insert(out.end(),
             {
                 {"",
                  "",
                  "contacts",
                  {},
                  [](auto& a) { return a.played() ? contact_order(a.landing.contacts) : "not played"; }},
                 {"", "evaluations", "motions evaluated", {}, [](auto& a) { return a.best.evaluations; }},
                 {"", "landings", "landings played", {}, [](auto& a) { return a.best.landings; }},
                 {"", "solver", [](auto& a) { return a.best.solver; }},
                 {"", "verified", [](auto& a) { return a.best.verified; }},
                 {"", "joint_lost", [](auto& a) { return a.played() ? Json(a.landing.joint_lost) : Json(); }},
             });
  return out;
}

/// Expected start of the landing motion, from release [s]: first touchdown + detection delay; infinite without one.
double expected_start(const Answer& a) {
  const double touchdown = a.landing.contacts.first();  // infinite where nothing was followed
  return (std::isfinite(touchdown) ? touchdown : first_touchdown(a.scene, a.best.sea, a.best.motion)) +
         a.scene.detection_delay;
}

Table solvers(const Answer& a) {
  return {Quantities<Optimum>{
              {"solver", &Optimum::solver},
              {"evaluations", &Optimum::evaluations},
              {"", "landings", &Optimum::landings},
              {"time_s", &Optimum::seconds},
              {"best", "", [](auto& o) { return o.found ? o.value : kNoMotion; }},
              {"", "value", [](auto& o) { return o.found ? Json(o.value) : Json(); }},
          },
          a.tried};
}

/// Improvements of each search's incumbent, at the search's accuracy.
std::string progress_csv(const Run& run, const Answer& a) {
  CsvWriter csv = run.csv();
  csv.header({"solver", "evaluations", "landings", "time_s", "best"});
  for (const Optimum& o : a.tried)
    for (const Progress& p : o.progress)
      csv.cell(o.solver).cell(p.motions).cell(p.landings).cell(p.seconds).cell(p.value).end_row();
  return csv.text();
}

/// In how many motions within the execution tolerance each forbidden point touches; warns of them.
Json forbidden_touches(const Answer& a, Run& run) {
  const TolerantPeak& t = a.best.tolerant;
  Json out;
  for (std::size_t j = 0; j < std::size_t(kPoints); ++j) {
    if (!a.options.search.limits.forbidden[j]) continue;
    const int box = t.touching[j], inside = t.samples_touching[j];
    out[kPointNames[j]] = {{"box", t.complete ? Json(box) : Json()},
                           {"of", kExecutionPoints},
                           {"sampled", inside},
                           {"samples", t.samples}};
    if (box + inside > 0)
      run.warn(
          fmt::format("the {} touches in {} of the {} motions of the execution box and in {} of {} random ones inside: "
                      "--forbid holds for those {} alone",
                      kPointNames[j], box, kExecutionPoints, inside, t.samples, kExecutionPoints));
  }
  return out;
}

/// Reports the motion with the smallest violation of the ratings, where none keeps them.
void report_least_breaking(const LeastBreaking& l, Run& run, Json& summary) {
  std::string rating = l.rating;
  std::replace(rating.begin(), rating.end(), '_', ' ');
  run.warn(fmt::format("the motion that breaks them least: {}; its {} is {:.4g} {}, {:.3g} times the {:.4g} allowed",
                       motion_words(l.motion), rating, l.demand, l.unit, l.excess(), l.limit));
  summary["least_breaking"] = {{"motion", motion_json(l.motion)},
                               {"rating", l.rating},
                               {"unit", l.unit},
                               {"demand", l.demand},
                               {"limit", l.limit}};
}

/// Warns of deviations that cost half of what the motion saves, or more.
void warn_of_deviations(const Answer& a, Run& run) {
  std::string costly;
  for (const Quantity<Evidence>& q : deviation_quantities()) {
    const double peak = q.value(*a.evidence).get<double>();
    if (peak > kWorse * a.peak() && !(a.held_peak() <= a.peak()) &&
        !(peak - a.peak() < 0.5 * (a.held_peak() - a.peak())))
      costly += fmt::format("{}{} {}", costly.empty() ? "" : ", ", short_peak_words(peak), q.words);
  }
  if (!costly.empty())
    run.warn(
        fmt::format("the peak of {:.4g} m/s^2 becomes {}; {} it is {}: half of what the motion saves, or more, is lost",
                    a.peak(), costly, held_words(a), short_peak_words(a.held_peak())));
  if (!a.evidence->complete && a.evidence->work > kCheckWork && !interrupted())
    run.warn(
        fmt::format("the landings of this scene are long ({} of them take {:.2g} steps or more): evidence is left out; "
                    "--evidence plays it",
                    Evidence::kLandings, double(a.evidence->work)));
}

void warn(const Answer& a, Run& run) {
  const TolerantPeak& t = a.best.tolerant;
  const ExecutionTolerance& box = a.scene.execution;
  warn_of(landing_doubts(a.instability, a.actuator.sea.tau_max), run);
  warn_of(landing_doubts(a.landing), run), warn_of(landing_doubts(a.held), run, held_words(a) + ": ");
  if (!a.best.message.empty()) run.warn(a.best.message);
  warn_of_edges(ReferenceSpace(a.scene, a.best.sea).variables(), a.best.edges, run);
  if (!a.best.verified) run.warn("there was no time to judge the motion at a tight accuracy: its peak is the search's");
  if (t.sampled > t.value)
    run.warn(fmt::format(
        "inside the execution tolerance a peak of {:.5g} was found, above the tolerant peak {:.5g} of its 15 points",
        t.sampled, t.value));
  if (a.tolerant_known && t.value > kWorse * a.peak())
    run.warn(
        fmt::format("the motion stands on a cliff: played within {:g} deg and {:g} ms its peak may reach {:.4g} m/s^2",
                    box.phi * kDegrees, box.duration * 1e3, t.value));
  if (a.evidence) warn_of_deviations(a, run);
}

Json summary_of(const Answer& a, Run& run) {
  const Optimum& o = a.best;
  Json s = Table::of(answer_quantities(a), a).object();
  if (a.played()) s["peak_time"] = number(a.landing.t_peak);
  s["tolerant_sampled"] = {{"samples", o.tolerant.samples},
                           {"worst", o.tolerant.samples > 0 ? number(o.tolerant.sampled) : Json()}};
  s["execution"] = {{"phi_deg", a.scene.execution.phi * kDegrees}, {"duration", a.scene.execution.duration}};
  if (a.options.search.limits.any_forbidden()) s["forbidden"] = forbidden_touches(a, run);
  s["contacts"] = a.played() ? Table(contact_quantities(words_of(a.scene.robot)), a.landing.touches).objects() : Json();
  s["peaks"] = a.played() ? peaks_json(a.landing.peaks) : Json();
  if (a.evidence) s["evidence"]["time_s"] = a.evidence_seconds;
  s["ratings"] = a.ratings ? ratings_json(*a.ratings) : Json();
  return s;
}

/// Gap of the incumbent to the lowest value [%], as steps, over evaluated motions, so that a page does not depend on
/// the machine; if `timed` over time [s].
Series descent(const Optimum& o, double lowest, bool timed) {
  constexpr double kMinGap = 1e-3;  // [%], of logarithmic axes
  Series out{o.solver, {}, {}};
  for (const Progress& p : o.progress) lowest = std::min(lowest, p.value);  // before it left a cliff
  const auto gap = [&](const Progress& p) { return std::max(100 * (p.value / lowest - 1), kMinGap); };
  const auto add_x = [&](double motions, double seconds) { out.x.push_back(timed ? seconds : motions); };
  for (const Progress& p : o.progress) {
    if (!(p.value < kNoMotion) || (!out.y.empty() && gap(p) > out.y.back())) continue;  // re-evaluated at the end
    if (!out.x.empty()) add_x(double(p.motions), p.seconds), out.y.push_back(out.y.back());
    add_x(double(p.motions), p.seconds), out.y.push_back(gap(p));
  }
  if (!out.x.empty()) add_x(double(o.evaluations), o.seconds), out.y.push_back(out.y.back());
  return out;
}

/// Peaks under each deviation, as planned and held.
Panel deviation_panel(const Answer& a) {
  std::vector<std::pair<std::string, double>> bars{{"as planned", a.peak()}};
  for (const Quantity<Evidence>& q : deviation_quantities())
    if (const double peak = q.value(*a.evidence).get<double>(); std::isfinite(peak)) bars.push_back({q.words, peak});
  bars.push_back({held_words(a), a.held_peak()});
  Panel out;
  out.x_label = "peak [m/s^2]";
  Series series{"", {}, {}, Series::Style::kBars, 0};
  for (const auto& [name, peak] : bars) {
    series.x.push_back(peak), series.y.push_back(double(bars.size() - out.rows.size()));
    out.rows.push_back(name);
  }
  out.series = {series};
  return out;
}

/// How far each variable may move, in percent of its search range.
Panel margin_panel(const Answer& a) {
  const std::vector<Variable> variables = ReferenceSpace(a.scene, a.actuator.sea).variables();
  Panel out;
  out.x_label = fmt::format("room before the peak rises by {:g} % [% of the search range]", 100 * Evidence::kRise);
  Series series{"", {}, {}, Series::Style::kIntervals, 0};
  for (std::size_t k = 0; k < variables.size(); ++k) {
    const double percent = 100 / (variables[k].upper - variables[k].lower);
    series.x.push_back(0), series.y.push_back(double(variables.size() - k));
    series.low.push_back(-a.evidence->width[k][0] * percent), series.high.push_back(a.evidence->width[k][1] * percent);
    out.rows.push_back(variables[k].words);
  }
  out.series = {series};
  return out;
}

Figure deviations(const Answer& a) {
  Figure out{.name = "deviations", .panels = {deviation_panel(a), margin_panel(a)}, .columns = 2};
  out.width = Figure::Width::kWhole;
  out.panel_height = 80 + 26.0 * double(std::max(out.panels[0].rows.size(), out.panels[1].rows.size()));
  out.caption =
      "What one thing that is not as planned makes of the peak, and how far each number of the motion may be off.";
  return out;
}

/// An axis of a slice.
struct SliceAxis {
  const char* label;
  MotionRange range;
  double box, unit;  ///< half-width of the execution box; shown = value * unit
};

/// The peak over two variables of the answer's motion, the others fixed.
Heatmap slice(const Answer& a, const SliceAxis& x, const SliceAxis& y) {
  constexpr int kCells = 31;
  const Motion& m = a.best.motion;
  Heatmap out{.x_label = x.label, .y_label = y.label};
  for (auto& [axis, along] : {std::pair(&out.x, &x), {&out.y, &y}})
    for (int i = 0; i < kCells; ++i)
      axis->push_back(std::lerp(along->range.low, along->range.high, double(i) / (kCells - 1)) * along->unit);
  out.values = peak_slice(a.scene, a.best.sea, m, x.range, y.range, kCells, a.options.search.threads);
  out.mark = {m.*x.range.number * x.unit, m.*y.range.number * y.unit, x.box * x.unit, y.box * y.unit};
  return out;
}

/// Adds heat maps of the peak around the answer: over the full ranges, and close-ups with the execution box.
void show_slices(const Answer& a, Report& report) {
  const SearchRange& range = a.scene.search;
  const ExecutionTolerance& box = a.scene.execution;
  const Motion& m = a.best.motion;
  const auto full_range = [&](const char* label, double Motion::*number) {
    return SliceAxis{label, {number, range.phi[0], range.phi[1]}, box.phi, kDegrees};
  };
  const auto zoom = [&](const char* label, double Motion::*number) {
    constexpr double kBoxes = 10;
    return SliceAxis{label, {number, m.*number - kBoxes * box.phi, m.*number + kBoxes * box.phi}, box.phi, kDegrees};
  };
  const SliceAxis duration{"duration [s]", {&Motion::duration, range.duration[0], range.duration[1]}, box.duration, 1};
  report.heading("Among its neighbours");
  report.paragraph(
      "The peak of the planned drop [m/s^2] over two numbers of the motion, the others as they are. The cross is the "
      "answer, the box about it how inexactly a robot may play it.");
  report.heatmap(slice(a, full_range("phi_I [deg]", &Motion::phi_i), full_range("phi_F [deg]", &Motion::phi_f)));
  report.heatmap(slice(a, full_range("phi_F [deg]", &Motion::phi_f), duration));
  if (box.phi > 0)
    report.heatmap(slice(a, zoom("phi_I [deg], close by", &Motion::phi_i), zoom("phi_F [deg]", &Motion::phi_f)));
}

Report page_of(const Answer& a, const Run& run) {
  Report report("Best landing: " + a.scene.name);
  report.answer(first_screen(a), run.warnings());
  const bool drawn = tools::drawn(a.options.search.deadline);
  std::optional<double> limit;
  if (a.limit && !a.best.motion.reposition) limit = a.limit->jump;
  if (drawn)
    show({a.scene,
          a.actuator,
          {{"best motion", &a.landing, a.under_scatter ? a.under_scatter->shown : std::vector<Landing>{}},
           {held_words(a), &a.held}},
          limit,
          ""},
         report);
  report.distrust(run.warnings());
  report.folded("All numbers", Table::of(answer_quantities(a), a).transposed());
  if (drawn && a.evidence && a.evidence->complete) {
    report.heading("When something is not as planned");
    report.figure(deviations(a));
  }
  if (drawn) show_scatter(a, report);
  const bool page = run.options().report == CommonOptions::Report::kWrite;
  if (page && drawn && a.evidence && a.evidence->complete) show_slices(a, report);
  report.heading("The search");
  std::vector<Series> descents;
  const bool timed = a.options.search.deadline.has_value();
  for (const Optimum& o : a.tried) descents.push_back(descent(o, a.best.value, timed));
  if (drawn)
    report.plot("search", timed ? "time [s]" : "motions evaluated", "gap to the lowest value [%]", descents,
                Axes::kLogarithmic);
  else
    report.paragraph(kNotDrawn);
  report.paragraph("Its numbers, and the time that they took: progress.csv.");
  constants_table(report, a.scene, a.actuator);
  floor_source(report, a.scene.floor_source);
  return report;
}

}  // namespace

std::map<std::string, std::string> files_of(const Answer& a, double rate, const Exports& exports, const Run& run) {
  const Motion& m = a.best.motion;
  const double start = m.reposition ? expected_start(a) : std::numeric_limits<double>::infinity();
  std::map<std::string, std::string> files = {{"motion.toml", to_toml(m, run.provenance_text())},
                                              {"motion.csv", to_csv(rows_of(m, start, rate), run.provenance_text())},
                                              {"solvers.csv", solvers(a).csv(run)},
                                              {"progress.csv", progress_csv(run, a)}};
  files.merge(exported(exports, m, start, a.landing, run));
  files.merge(page_of(a, run).files(run));
  return files;
}

int report(const Answer& a, double rate, const Exports& exports, Run& run) {
  const OptimizeOptions& searched = a.options.search;
  Json summary;
  if (a.best.found) {
    warn(a, run);
    summary = summary_of(a, run);
    if (a.ratings) warn_of(landing_doubts(*a.ratings), run);
    if (a.scattered && a.scatter && a.scatter_assumed) warn_of_assumed(*a.scatter, run);
    const std::string contacts = a.played() ? contact_order(a.landing.contacts) : "";
    say(first_screen(a),
        {"motion: " + motion_words(a.best.motion),
         contacts.empty() ? "its landing was not played: no time" : "contacts: " + contacts},
        Table::of(answer_quantities(a), a).transposed(), run);
    if (a.limit && run.options().lines == CommonOptions::Lines::kAll)
      run.say(fmt::format("limit {:.1f}, held through the first contact {:.1f}, yours {:.1f}, held throughout {}",
                          a.limit->jump, a.limit->first_contact, a.peak(), short_peak_words(a.held_peak())));
    report_scatter(a, run);
    run.say(fmt::format("searched for {:.2f} s", a.best.seconds));
    if (exports.has(Exports::Format::kPlotJuggler) && !a.played())
      run.warn("plotjuggler.csv is not written: there was no time to play the landing");
    for (auto& [name, content] : files_of(a, rate, exports, run)) run.add(name, content);
  } else {
    run.warn(a.best.message);
    summary = {{"motion", nullptr},
               {"evaluations", a.best.evaluations},
               {"solver", a.options.solvers.empty() ? searched.solver : "compare"}};
    if (a.least_breaking) report_least_breaking(*a.least_breaking, run, summary);
  }
  summary["objective"] = kGoalNames[std::size_t(searched.goal)];
  if (a.best.found) summary.update(scatter_json(a));
  summary["seed"] = searched.seed;
  if (!a.options.solvers.empty()) summary["solvers"] = solvers(a).objects();
  return run.finish(summary, a.best.found ? kDone : kNumbers);
}

}  // namespace ukemi::tools

#include "tools/report/design.hpp"

#include <fmt/format.h>

#include <cmath>

#include "identify/fit/fit.hpp"
#include "tools/report/report.hpp"

namespace ukemi::tools {

using namespace identify;

namespace {

std::string percent(double relative) {
  return std::isfinite(relative) ? fmt::format("± {:.3g} %", 100 * relative) : "not determined";
}
std::string milliseconds(double seconds) { return fmt::format("{:.2f} ms", 1e3 * seconds); }

/// A constant's relative 95 % half width.
struct ErrorBar {
  std::string name, unit;
  double value, before, after;  ///< after: NaN where nothing is proposed
};
const Quantities<ErrorBar> kErrorBarQuantities = {
    {"", "", "constant", {}, &ErrorBar::name},
    {"", "value", "estimate", "{:.6g}", &ErrorBar::value},
    {"", "unit", "unit", {}, &ErrorBar::unit},
    {"", "half_width_before", "95 % before", percent, &ErrorBar::before},
    {"", "half_width_after", "95 % after, predicted", percent, &ErrorBar::after},
};

struct HitRow {
  std::size_t n;
  ProposedHit proposed;
  double start, largest_angle;
};
const Quantities<HitRow> kHitQuantities = {
    {"hit", "", "hit", {}, &HitRow::n},
    {"peak", "peak", "peak [N]", "{:.1f}", [](auto& h) { return h.proposed.hit.peak; }},
    {"width", "width", "width", milliseconds, [](auto& h) { return h.proposed.hit.width; }},
    {"start", &HitRow::start},
    {"angle", "angle", "largest |phi_1| [rad]", "{:.4f}", [](auto& h) { return h.proposed.safety.angle; }},
    {"angle_worst", "angle_within_uncertainty", "within the uncertainty [rad]", "{:.4f}",
     [](auto& h) { return h.proposed.safety.worst_angle; }},
    {"", "margin", [](auto& h) { return h.largest_angle - h.proposed.safety.worst_angle; }},
    {"torque", "spring_torque", "spring torque before the limit [Nm]", "{:.1f}",
     [](auto& h) { return h.proposed.safety.torque; }},
    {"limited", "time_at_limit", "at the limit", milliseconds, [](auto& h) { return h.proposed.safety.limited; }},
};

struct CheckRow {
  std::string name;
  DesignCheck::Constant constant;
  int repeats;
};
const Quantities<CheckRow> kCheckQuantities = {
    {"", "", "constant", {}, &CheckRow::name},
    {"", "std_predicted", "standard error, predicted", percent, [](auto& c) { return c.constant.predicted; }},
    {"", "scatter", "scatter of the refits", percent, [](auto& c) { return c.constant.scatter; }},
    {"", "half_width", "their mean 95 % half-width", percent, [](auto& c) { return c.constant.half_width; }},
    {"", "covered", "intervals that hold the truth", {}, [](auto& c) { return c.constant.covered; }},
    {"", "", "of", {}, &CheckRow::repeats},
};

std::vector<ErrorBar> error_bars(const Knowledge& k, const Design& d) {
  std::vector<ErrorBar> out;
  const auto u = constants(k.sea);
  for (std::size_t i = 0; i < k.constants.size(); ++i) {
    const std::size_t c = std::size_t(k.constants[i]);
    out.push_back(
        {kConstantNames[c], kConstantUnits[c], u[c], d.before[long(i)], d.hits.empty() ? NAN : d.after[long(i)]});
  }
  return out;
}
std::vector<HitRow> hit_rows(const Design& d, const DesignOptions& o) {
  std::vector<HitRow> out;
  for (const ProposedHit& h : d.hits) out.push_back({out.size() + 1, h, o.log.start, o.budget.angle});
  return out;
}
std::vector<CheckRow> check_rows(const Knowledge& k, const DesignCheck& check) {
  std::vector<CheckRow> out;
  for (std::size_t i = 0; i < k.constants.size(); ++i)
    out.push_back({kConstantNames[std::size_t(k.constants[i])], check.constants[i], check.repeats});
  return out;
}
/// An object with a key for each row.
template <class Row>
Json keyed(const Table& table, const std::vector<Row>& rows) {
  Json out;
  for (std::size_t i = 0; i < rows.size(); ++i) out[rows[i].name] = table.object(i);
  return out;
}

std::string words(const Hit& hit) { return fmt::format("{:.1f} N for {:.2f} ms", hit.peak, 1e3 * hit.width); }

std::string force_csv(const Run& run, const Trial& log) {
  CsvWriter csv = run.csv();
  csv.comment("The force to play at the link's tip, linear between samples. Units: s, N.");
  csv.header({"t", "force"});
  for (std::size_t i = 0; i < log.samples(); ++i) csv.row({log.t[i], log.force[i]});
  return csv.text();
}

void plot_hits(Report& report, const DesignQuestion& question, const Design& d, const std::vector<Trial>& logs) {
  const Fit motion = predict(question.rig, logs, question.knowledge.sea);
  std::vector<Series> forces, angles;
  for (std::size_t i = 0; i < logs.size(); ++i) {
    forces.push_back({words(d.hits[i].hit), logs[i].t, logs[i].force});
    angles.push_back({words(d.hits[i].hit), logs[i].t, motion.trials[i].phi});
  }
  report.plot("t [s]", "force [N]", forces);
  report.plot("t [s]", "phi_1, predicted [rad]", angles);
}

Json runners_up(Report& report, const Design& d) {
  Json out = Json::array();
  std::vector<std::vector<std::string>> rows;
  for (const RunnerUp& r : d.runners_up) {
    Json hits = Json::array();
    std::string text;
    for (const Hit& h : r.hits) {
      hits.push_back({{"peak", number(h.peak)}, {"width", number(h.width)}});
      text += (text.empty() ? "" : "; ") + words(h);
    }
    out.push_back({{"hits", hits}, {"criterion", number(r.size)}});
    rows.push_back({text, fmt::format("{:.2f}", r.size / d.size_after)});
  }
  report.heading("Runners-up");
  report.table({"hits", "criterion against the proposal's"}, rows);
  return out;
}

Json check_of(Report& report, const Knowledge& k, const DesignCheck& c, const Run& run) {
  const std::vector<CheckRow> rows = check_rows(k, c);
  const Table table(kCheckQuantities, rows);
  const std::string verdict = fmt::format(
      "{} experiments simulated at the estimate and refitted, {} failed: the "
      "predicted bars {}",
      c.repeats, c.failed, c.agrees ? "come true" : "do not come true");
  run.say("check: " + verdict);
  report.heading("Check by simulation");
  report.paragraph(verdict + ".");
  report.table(table);
  return {{"repeats", c.repeats}, {"failed", c.failed}, {"agrees", c.agrees}, {"constants", keyed(table, rows)}};
}

}  // namespace

int report(const DesignQuestion& question, const DesignAnswer& answer, Json summary, Run& run) {
  const Design& d = answer.design;
  const DesignOptions& o = question.options;
  const Knowledge& k = question.knowledge;
  const bool found = d.status == Design::Status::kDone, agrees = !answer.check || answer.check->agrees;
  if (!found) run.warn(d.message);
  if (!agrees) run.warn("the simulated experiments scatter otherwise than predicted: see the check");
  const std::vector<ErrorBar> bars = error_bars(k, d);
  const Table constants(kErrorBarQuantities, bars), hits(kHitQuantities, hit_rows(d, o));
  Report report("The next hits");
  report.paragraph(found ? "Done." : d.message);
  report.list(run.warnings());
  report.heading("Error bars, 95 %, relative");
  report.table(constants);
  say(constants, run);

  summary["criterion"] = {
      {"name", name(o.criterion)}, {"before", number(d.size_before)}, {"after", number(d.size_after)}};
  summary["constants"] = keyed(constants, bars);
  summary["in_hand"] = question.trials == 0 ? "the actuator's covariance" : fmt::format("{} trials", question.trials);
  summary["noise"] = number(o.log.noise);
  summary["tau_max"] = number(k.sea.tau_max);
  summary["hits"] = hits.objects();
  summary["runners_up"] = Json::array();
  summary["candidates"] = {{"looked_at", d.candidates}, {"beyond_the_angle", d.too_far}, {"escaping", d.escaping}};
  summary["check"] = nullptr;
  if (found) {
    say(hits, run);
    report.heading("Hits");
    report.table(hits);
    std::vector<Trial> logs;
    for (const ProposedHit& h : d.hits) {
      logs.push_back(blank_log(h.hit, o.log));
      run.add(fmt::format("hit_{}.csv", logs.size()), force_csv(run, logs.back()));
    }
    run.add("hits.csv", hits.csv(run,
                                 "Proposed half-sine hits at the tip. angle_worst: largest |phi_1| within the "
                                 "estimate's 95 % ellipsoid; torque: largest of the spring before the limit; limited: "
                                 "how long the limit acts. Units: N, s, rad, Nm."));
    plot_hits(report, question, d, logs);
    summary["runners_up"] = runners_up(report, d);
    if (answer.check) summary["check"] = check_of(report, k, *answer.check, run);
  }
  run.add("report.html", report.html(run.provenance()));
  return run.finish(summary, found && agrees ? kDone : kNumbers);
}

}  // namespace ukemi::tools

#include "tools/report/design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "identify/fit/fit.hpp"
#include "tools/report/report.hpp"

namespace ukemi::tools {

const Outputs kDesignOutputs{"design", {"hit_#.csv", "hits.csv", "next.csv"}, {"force", "angle"}};

using namespace identify;

namespace {

/// "± 3.2 %" of a relative half-width [1]; "not determined" where it is not finite.
std::string half_width_words(double relative) {
  return std::isfinite(relative) ? fmt::format("± {:.3g} %", 100 * relative) : "not determined";
}

std::string milliseconds(double seconds) { return fmt::format("{:.2f} ms", 1e3 * seconds); }

std::size_t constant_index(const Knowledge& k, std::size_t i) { return std::size_t(k.constants[i]); }
/// Columns of an uncertain constant, given by its index among them: relative 95 % half-widths.
Quantities<std::size_t> error_bar_quantities(const Knowledge& k, const Design& d) {
  return {
      {"", "", "constant", {}, [&k](auto& i) { return kConstantNames[constant_index(k, i)]; }},
      {"", "value", "estimate", "{:.6g}", [&k](auto& i) { return constants(k.sea)[constant_index(k, i)]; }},
      {"", "unit", "unit", {}, [&k](auto& i) { return kConstantUnits[constant_index(k, i)]; }},
      {"", "half_width_before", "95 % before", half_width_words, [&d](auto& i) { return d.before[long(i)]; }},
      {"", "half_width_after", "95 % after, predicted", half_width_words,
       [&d](auto& i) { return d.hits.empty() ? NAN : d.after[long(i)]; }},
  };
}
Quantities<std::size_t> check_quantities(const Knowledge& k, const DesignCheck& c) {
  return {
      {"", "", "constant", {}, [&k](auto& i) { return kConstantNames[constant_index(k, i)]; }},
      {"", "std_predicted", "standard error, predicted", half_width_words,
       [&c](auto& i) { return c.constants[i].predicted; }},
      {"", "scatter", "scatter of the refits", half_width_words, [&c](auto& i) { return c.constants[i].scatter; }},
      {"", "half_width", "their mean 95 % half-width", half_width_words,
       [&c](auto& i) { return c.constants[i].half_width; }},
      {"", "covered", "intervals that hold the truth", {}, [&c](auto& i) { return c.constants[i].covered; }},
      {"", "", "of", {}, [&c](auto&) { return c.repeats; }},
  };
}
/// 0, ..., n - 1.
std::vector<std::size_t> indices(std::size_t n) {
  std::vector<std::size_t> out(n);
  std::iota(out.begin(), out.end(), std::size_t(0));
  return out;
}

/// The criterion of a design of either kind, before and after what it proposes.
template <class Designed>
Json criterion_json(Criterion criterion, const Designed& d) {
  return {{"name", name(criterion)}, {"before", number(d.size_before)}, {"after", number(d.size_after)}};
}
template <class Designed>
std::string criterion_words(Criterion criterion, const Designed& d) {
  return fmt::format("the criterion ({}) goes from {:.3g} to {:.3g}", name(criterion), d.size_before, d.size_after);
}

Quantities<ProposedHit> hit_quantities(const Design& d, const DesignOptions& o) {
  return {
      {"hit", "", "hit", {}, [&d](auto& h) { return &h - d.hits.data() + 1; }},
      {"peak", "peak", "peak [N]", "{:.1f}", [](auto& h) { return h.hit.peak; }},
      {"width", "width", "width", milliseconds, [](auto& h) { return h.hit.width; }},
      {"start", [&o](auto&) { return o.log.start; }},
      {"angle", "angle", "largest |phi_1| [rad]", "{:.4f}", [](auto& h) { return h.safety.angle; }},
      {"angle_worst", "angle_within_uncertainty", "within the uncertainty [rad]", "{:.4f}",
       [](auto& h) { return h.safety.worst_angle; }},
      {"", "margin", [&o](auto& h) { return o.budget.angle - h.safety.worst_angle; }},
      {"torque", "spring_torque", "spring torque before the limit [Nm]", "{:.1f}",
       [](auto& h) { return h.safety.torque; }},
      {"limited", "time_at_limit", "at the limit", milliseconds, [](auto& h) { return h.safety.limited; }},
  };
}

std::string words(const Hit& hit) { return fmt::format("{:.1f} N for {:.2f} ms", hit.peak, 1e3 * hit.width); }

std::string force_csv(const Run& run, const Trial& log) {
  CsvWriter csv = run.csv();
  csv.comment("The force to play at the link's tip, linear between samples. Units: s, N.");
  csv.header({"t", "force"});
  for (std::size_t i = 0; i < log.samples(); ++i) csv.row({log.t[i], log.force[i]});
  return csv.text();
}

/// Plots the proposed hits over those in hand.
void plot_hits(Report& report, const DesignQuestion& question, const Design& d, const std::vector<Trial>& logs) {
  const Fit motion = predict(question.rig, logs, question.knowledge.sea);
  std::vector<Series> forces, angles;
  const double t_end = logs.empty() || logs[0].t.empty() ? 0 : logs[0].t.back();
  for (const Trial& t : question.trials) {
    const bool first = &t == &question.trials.front();
    const auto faint_curve = [&](const std::vector<double>& y) {
      Series s{first ? "in hand" : "", {}, {}, Series::Style::kFaint, Series::kGrey};
      for (std::size_t i = 0; i < y.size() && t.t[i] - t.t[0] <= t_end; ++i)
        s.x.push_back(t.t[i] - t.t[0]), s.y.push_back(y[i]);
      return s;
    };
    if (t.force_t.empty()) forces.push_back(faint_curve(t.force));
    angles.push_back(faint_curve(t.phi));
  }
  for (std::size_t i = 0; i < logs.size(); ++i) {
    forces.push_back({words(d.hits[i].hit), logs[i].t, logs[i].force});
    angles.push_back({words(d.hits[i].hit), logs[i].t, motion.trials[i].phi});
  }
  if (!question.trials.empty()) report.paragraph("The proposal, and in grey the hits in hand.");
  report.plot("force", "t [s]", "force [N]", forces);
  report.plot("angle", "t [s]", "phi_1, predicted [rad]", angles);
}

std::string hits_words(const RunnerUp& r) {
  std::string text;
  for (const Hit& h : r.hits) text += (text.empty() ? "" : "; ") + words(h);
  return text;
}
Json hits_json(const RunnerUp& r) {
  Json out = Json::array();
  for (const Hit& h : r.hits) out.push_back({{"peak", number(h.peak)}, {"width", number(h.width)}});
  return out;
}
Quantities<RunnerUp> runner_up_quantities(const Design& d) {
  return {
      {"", "", "hits", {}, hits_words},
      {"", "hits", hits_json},
      {"", "criterion", &RunnerUp::size},
      {"", "", "criterion against the proposal's", "{:.2f}", [&d](auto& r) { return r.size / d.size_after; }},
  };
}

Json report_check(Report& report, const Knowledge& k, const DesignCheck& c, const Run& run) {
  const Table constants(check_quantities(k, c), indices(k.constants.size()));
  const std::string verdict =
      fmt::format("{} experiments simulated at the estimate and refitted, {} failed: the predicted bars {}", c.repeats,
                  c.failed, c.agrees ? "come true" : "do not come true");
  run.say("check: " + verdict);
  report.heading("Check by simulation");
  report.paragraph(verdict + ".");
  report.table(constants);
  return {{"repeats", c.repeats}, {"failed", c.failed}, {"agrees", c.agrees}, {"constants", constants.keyed()}};
}

// --- of a robot of links ---

/// Columns of a constant, given by its index: 95 % half-widths relative to its value or to `part_of`.
Quantities<std::size_t> error_bar_quantities(const RobotDesign& d) {
  return {
      {"", "", "constant", {}, [&d](auto& i) { return d.constants[i]; }},
      {"", "value", "value", "{:.6g}", [&d](auto& i) { return number(d.value[long(i)]); }},
      {"", "unit", "unit", {}, [&d](auto& i) { return d.units[i]; }},
      {"", "part_of", "in parts of", "{:.6g}", [&d](auto& i) { return number(d.scale[long(i)]); }},
      {"", "half_width_before", "95 % before", half_width_words, [&d](auto& i) { return number(d.before[long(i)]); }},
      {"", "half_width_after", "95 % after, predicted", half_width_words,
       [&d](auto& i) { return number(d.after[long(i)]); }},
  };
}

/// The constant with the largest relative half-width, and that.
std::string worst_of(const RobotDesign& d, const CandidateTrial& t) {
  if (!t.followed) return "";
  long worst = 0;
  const double width = t.half_width.maxCoeff(&worst);
  return fmt::format("{} {}", d.constants[std::size_t(worst)], half_width_words(width));
}

Quantities<CandidateTrial> candidate_quantities(const RobotDesign& d) {
  const auto number_if = [](double x, bool condition) { return condition ? number(x) : Json(); };
  return {
      {"rank", "rank", "rank", {}, [number_if](auto& t) { return number_if(t.rank, t.rank > 0); }},
      {"file", "file", "commands", {}, [](auto& t) { return t.file; }},
      {"together", "together", "criterion with those before it", "{:.3g}",
       [number_if](auto& t) { return number_if(t.together, t.rank > 0); }},
      {"alone", "alone", "alone", "{:.3g}", [number_if](auto& t) { return number_if(t.alone, t.followed); }},
      {"", "", "then known worst", {}, [&d](auto& t) { return worst_of(d, t); }},
      {"", "followed", [](auto& t) { return t.followed; }},
  };
}

Json noise_of(const RobotDesign& d) {
  Json out = Json::object();
  for (std::size_t o = 0; o < d.noise.size(); ++o)
    if (std::isfinite(d.noise[o])) out[d.channels[o].name] = number(d.noise[o]);
  return out;
}

}  // namespace

int report(const DesignQuestion& question, const DesignAnswer& answer, Json summary, Run& run) {
  const Design& d = answer.design;
  const DesignOptions& o = question.options;
  const Knowledge& k = question.knowledge;
  const bool found = d.status == Design::Status::kDone, agrees = !answer.check || answer.check->agrees;
  if (!found) run.warn(d.message);
  if (!agrees) run.warn("the simulated experiments scatter otherwise than predicted: see the check");
  const Table bars(error_bar_quantities(k, d), indices(k.constants.size())), hits(hit_quantities(d, o), d.hits);
  Report report("The next hits");
  report.distrust(run.warnings());
  report.heading("Error bars, 95 %, relative");
  (void)add_table(bars, report, run);

  summary["criterion"] = criterion_json(o.criterion, d);
  summary["constants"] = bars.keyed();
  summary["in_hand"] =
      question.trials.empty() ? "the actuator's covariance" : fmt::format("{} trials", question.trials.size());
  summary["noise"] = number(o.log.noise);
  summary["tau_max"] = number(k.sea.tau_max);
  summary["hits"] = hits.objects();
  summary["runners_up"] = Json::array();
  summary["candidates"] = {{"looked_at", d.candidates}, {"beyond_the_angle", d.too_far}, {"escaping", d.escaping}};
  summary["check"] = nullptr;
  if (found) {
    report.heading("Hits");
    (void)add_table(
        hits, report, run, "hits.csv",
        "Proposed half-sine hits at the tip. angle_worst: largest |phi_1| within the estimate's 95 % ellipsoid; "
        "torque: largest of the spring before the limit; limited: how long the limit acts. Units: N, s, rad, Nm.");
    std::vector<Trial> logs;
    for (const ProposedHit& h : d.hits) {
      logs.push_back(blank_log(h.hit, o.log));
      run.add(fmt::format("hit_{}.csv", logs.size()), force_csv(run, logs.back()));
    }
    plot_hits(report, question, d, logs);
    const Table others(runner_up_quantities(d), d.runners_up);
    report.heading("Runners-up");
    report.table(others);
    summary["runners_up"] = others.objects();
    if (answer.check) summary["check"] = report_check(report, k, *answer.check, run);
  }
  FirstScreen first{.sentence = d.message};
  if (found)
    first.sentence =
        fmt::format("{} proposed: {}.", d.hits.size() == 1 ? "One hit is" : fmt::format("{} hits are", d.hits.size()),
                    criterion_words(o.criterion, d));
  first.checks = {check(found, "found", found ? "" : d.message),
                  answer.check ? check(agrees, "the predicted bars come true", "by simulated experiments")
                               : Check{Check::State::kUnknown, "the predicted bars come true", "not simulated"}};
  if (found) first.next = "Play hits.csv on the robot, then `ukemi identify` with the new logs.";
  report.answer(first, run.warnings());
  report.write(run);
  return run.finish(summary, found && agrees ? kDone : kNumbers);
}

int report(const RobotDesign& d, Run& run) {
  std::vector<CandidateTrial> order = d.candidates;
  std::stable_sort(order.begin(), order.end(), [](const CandidateTrial& a, const CandidateTrial& b) {
    const auto key = [](const CandidateTrial& t) {
      return std::pair(t.rank > 0 ? t.rank : 1 << 20, t.followed ? t.alone : HUGE_VAL);
    };
    return key(a) < key(b);
  });
  for (const CandidateTrial& t : order)
    if (!t.followed) run.warn(t.file + ": the robot cannot be simulated under these commands");
  for (const std::string& doubt : d.doubts) run.warn(doubt);
  if (!d.doubts.empty()) run.warn("the trials in hand reject the robot: errors to come are larger than predicted");
  const Table bars(error_bar_quantities(d), indices(d.constants.size())), candidates(candidate_quantities(d), order);
  const auto chosen = std::count_if(order.begin(), order.end(), [](auto& t) { return t.rank > 0; });
  Report report("The next trials");
  report.distrust(run.warnings());
  report.heading("What to log next");
  (void)add_table(candidates, report, run, "next.csv",
                  "Candidates, the best to log next first. together: the criterion with what is in hand and all of "
                  "lower rank; alone: with this one.");
  report.heading("Error bars, 95 %, relative");
  (void)add_table(bars, report, run);
  const Json summary = {{"criterion", criterion_json(d.criterion, d)},
                        {"constants", bars.keyed()},
                        {"in_hand", fmt::format("{} trials", d.in_hand)},
                        {"noise", noise_of(d)},
                        {"candidates", candidates.objects()}};
  FirstScreen first;
  if (chosen > 0)
    first.sentence = fmt::format("Log {} next: {}.", order[0].file, criterion_words(d.criterion, d));
  else
    first.sentence = "The robot cannot be simulated under any of these commands.";
  const auto undetermined = std::count_if(d.after.begin(), d.after.end(), [](double x) { return !std::isfinite(x); });
  first.checks = {check(undetermined == 0, "every constant is determined then",
                        undetermined == 0 ? "" : fmt::format("{} stay open: other commands are needed", undetermined))};
  if (chosen > 0) first.next = "Play them on the robot, then `ukemi identify --robot` with the new logs.";
  report.answer(first, run.warnings());
  report.write(run);
  return run.finish(summary, chosen > 0 ? kDone : kNumbers);
}

}  // namespace ukemi::tools

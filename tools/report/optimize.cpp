#include "tools/report/optimize.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "landing/model/scene_file.hpp"
#include "tools/program/interrupt.hpp"
#include "tools/report/landing.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

/// The answer's quantities, a group a line on the terminal.
struct Groups {
  Quantities<Answer> motion, peaks, deviations, search;
  Quantities<Answer> all() const {
    Quantities<Answer> out;
    for (const Quantities<Answer>* group : {&motion, &peaks, &deviations, &search})
      append(out, *group, std::identity());
    return out;
  }
};

Groups groups_of(const OptimizeQuestion& question, const Answer& answer) {
  const ExecutionTolerance& box = question.scene.execution;
  Groups g;
  append(
      g.motion, motion_quantities(), [](const Answer& a) { return a.best.motion; }, "motion/");
  g.peaks = {
      {"", "peak_acceleration", "peak |ddr_0|", "m/s^2", peak_words, &Answer::peak},
      {"", "tolerant_peak",
       fmt::format("tolerant peak (within {:g} deg, {:g} ms)", box.phi * kDegrees, box.duration * 1e3), "m/s^2",
       peak_words, [](auto& a) { return a.tolerant_known ? Json(a.best.tolerant.value) : Json(); }},
      {"", "hold/peak_acceleration", "held at -45 deg", "m/s^2", peak_words, &Answer::held_peak},
      {"", "reduction", "reduction", "", percent_words, &Answer::reduction},
  };
  if (answer.evidence)
    append(
        g.deviations, deviation_quantities(), [](const Answer& a) { return *a.evidence; }, "evidence/");
  g.search = {
      {"", "", "contacts", "", {}, [](auto& a) { return a.played() ? contact_order(a.landing) : "not played"; }},
      {"", "evaluations", "motions evaluated", "", {}, [](auto& a) { return a.best.evaluations; }},
  };
  return g;
}

/// What a robot plays: t = 0 at the detected first touchdown.
std::string motion_csv(const Run& run, const Motion& m, double rate) {
  CsvWriter csv = run.csv();
  csv.comment("t = 0 at the detected first touchdown; before it hold phi_ref of the first row. Units: s, rad, rad/s.");
  csv.header({"t", "phi_ref", "dphi_ref"});
  const long rows = long(std::ceil(m.duration * rate - 1e-9));
  for (long i = 0; i <= rows; ++i) {
    const double t = std::min(double(i) / rate, m.duration);
    const Reference<double> r = quintic(m.phi_i, m.phi_f, m.duration, t);
    csv.row({t, r.phi, r.dphi});
  }
  return csv.text();
}

Table solvers(const Answer& a) {
  return {Quantities<Optimum>{
              {"solver", "solver", "", "", {}, &Optimum::solver},
              {"evaluations", "evaluations", "", "", {}, &Optimum::evaluations},
              {"", "landings", "", "", {}, &Optimum::landings},
              {"time_s", "time_s", "", "", {}, &Optimum::seconds},
              {"best", "", "", "", {}, [](auto& o) { return o.found ? o.value : kNoMotion; }},
              {"", "value", "", "", {}, [](auto& o) { return o.found ? Json(o.value) : Json(); }},
          },
          a.tried};
}

/// The moments at which a search's best became better, in the search's own accuracy.
std::string progress_csv(const Run& run, const Answer& a) {
  CsvWriter csv = run.csv();
  csv.header({"solver", "evaluations", "landings", "time_s", "best"});
  for (const Optimum& o : a.tried)
    for (const Progress& p : o.progress)
      csv.cell(o.solver).cell(p.motions).cell(p.landings).cell(p.seconds).cell(p.best.value).end_row();
  return csv.text();
}

/// Where forbidden points touch after all when the motion is played inexactly.
Json forbidden_touches(const OptimizeQuestion& question, const Answer& a, Run& run) {
  const TolerantPeak& t = a.best.tolerant;
  const bool exact = question.options.search.goal == Goal::kPeak;
  Json out;
  for (std::size_t j = 0; j < std::size_t(kPoints); ++j) {
    if (!question.options.search.limits.forbidden[j]) continue;
    const int box = t.touching[j], inside = t.samples_touching[j];
    out[kPointNames[j]] = {{"box", t.complete ? Json(box) : Json()},
                           {"of", kExecutionPoints},
                           {"sampled", inside},
                           {"samples", t.samples}};
    if (box + inside > 0)
      run.warn(fmt::format(
          "the {} touches in {} of the {} motions of the execution box and in {} of {} random ones inside: --forbid "
          "holds for {}",
          kPointNames[j], box, kExecutionPoints, inside, t.samples,
          exact ? "the exact motion alone" : "those fifteen alone"));
    else if (!t.complete && exact)
      run.warn("--forbid holds for the exact motion: there was no time to play its execution box");
  }
  return out;
}

/// Which deviations cost half of what the motion saves, or more.
void warn_of_deviations(const Answer& a, Run& run) {
  std::string lost;
  for (const Quantity<Evidence>& q : deviation_quantities()) {
    const double peak = q.value(*a.evidence).get<double>();
    if (peak > 1.05 * a.peak() && !(peak - a.peak() < 0.5 * (a.held_peak() - a.peak())))
      lost += fmt::format("{}{} {}", lost.empty() ? "" : ", ", short_peak_words(peak), q.words);
  }
  if (!lost.empty())
    run.warn(
        fmt::format("the peak of {:.4g} m/s^2 becomes {}; held at -45 deg it is {}: half of what the motion saves, or "
                    "more, is lost",
                    a.peak(), lost, short_peak_words(a.held_peak())));
  if (!a.evidence->complete && a.evidence->work > kCheckWork && !interrupted())
    run.warn(fmt::format(
        "the landings of this scene are long ({} of them take {:.2g} steps or more): evidence is left out; --evidence "
        "plays it",
        Evidence::kLandings, double(a.evidence->work)));
}

void warn(const OptimizeQuestion& question, const Answer& a, Run& run) {
  const TolerantPeak& t = a.best.tolerant;
  const ExecutionTolerance& box = question.scene.execution;
  warn_of(a.instability, question.actuator.sea.tau_max, run);
  if (!a.best.message.empty()) run.warn(a.best.message);
  if (!a.best.verified) run.warn("there was no time to judge the motion at a tight accuracy: its peak is the search's");
  if (t.sampled > t.value)
    run.warn(fmt::format(
        "inside the execution tolerance a peak of {:.5g} was found, above the tolerant peak {:.5g} of its 15 points",
        t.sampled, t.value));
  if (a.tolerant_known && t.value > 1.05 * a.peak())
    run.warn(
        fmt::format("the motion stands on a cliff: played within {:g} deg and {:g} ms its peak may reach {:.4g} m/s^2",
                    box.phi * kDegrees, box.duration * 1e3, t.value));
  if (a.evidence) warn_of_deviations(a, run);
}

Json summary_of(const OptimizeQuestion& question, const Answer& a, const Groups& groups, Run& run) {
  const Optimum& o = a.best;
  Json s = Table::of(groups.all(), a).object();
  s["hold"]["phi_deg"] = std::lround(kHeld.phi_i * kDegrees);
  s["verified"] = o.verified;
  if (a.played()) s["peak_time"] = number(a.landing.t_peak);
  s["tolerant_sampled"] = {{"samples", o.tolerant.samples},
                           {"worst", o.tolerant.samples > 0 ? number(o.tolerant.sampled) : Json()}};
  s["execution"] = {{"phi_deg", question.scene.execution.phi * kDegrees},
                    {"duration", question.scene.execution.duration}};
  if (question.options.search.limits.any_forbidden()) s["forbidden"] = forbidden_touches(question, a, run);
  s["contacts"] = a.played() ? contacts_json(a.landing) : Json();
  s["peaks"] = a.played() ? peaks_json(a.landing) : Json();
  if (a.evidence) {
    s["evidence"] = Table::of(evidence_quantities(), *a.evidence).object();
    s["evidence"]["time_s"] = a.evidence_seconds;
  }
  s["ratings"] = a.ratings ? ratings_json(*a.ratings) : Json();
  s["landings"] = o.landings;
  s["solver"] = o.solver;
  return s;
}

std::string html(const OptimizeQuestion& question, const Answer& a, const Run& run) {
  Report report("Best landing: " + question.scene.name);
  floor_source(report, question.scene);
  report.table({"", "value"}, Table::of(groups_of(question, a).all(), a).pairs());
  report.list(run.warnings());
  plot_landing(report, a.landing.trajectory);
  return report.html(run.provenance());
}

}  // namespace

std::map<std::string, std::string> files_of(const OptimizeQuestion& question, const Answer& a, const Run& run) {
  std::map<std::string, std::string> files = {{"motion.toml", to_toml(a.best.motion, run.provenance_text())},
                                              {"motion.csv", motion_csv(run, a.best.motion, question.rate)},
                                              {"solvers.csv", solvers(a).csv(run)},
                                              {"progress.csv", progress_csv(run, a)}};
  if (run.options().report == CommonOptions::Report::kWrite) files["report.html"] = html(question, a, run);
  return files;
}

int report(const OptimizeQuestion& question, const Answer& a, Run& run) {
  const OptimizeOptions& searched = question.options.search;
  Json summary;
  if (a.best.found) {
    const Groups groups = groups_of(question, a);
    warn(question, a, run);
    summary = summary_of(question, a, groups, run);
    if (a.ratings) warn_of(*a.ratings, run);
    run.say("motion: " + Table::of(groups.motion, a).line());
    run.say(Table::of(groups.peaks, a).line());
    if (a.evidence && a.evidence->complete) run.say("peak " + Table::of(groups.deviations, a).line());
    run.say(Table::of(groups.search, a).line() + fmt::format(" in {:.2f} s", a.best.seconds));
    for (auto& [name, content] : files_of(question, a, run)) run.add(name, content);
  } else {
    run.warn(a.best.message);
    summary = {{"motion", nullptr},
               {"evaluations", a.best.evaluations},
               {"solver", question.options.solvers.empty() ? searched.solver : "compare"}};
  }
  summary["objective"] = kGoalNames[std::size_t(searched.goal)];
  summary["seed"] = searched.seed;
  if (!question.options.solvers.empty()) summary["solvers"] = solvers(a).objects();
  return run.finish(summary, a.best.found ? kDone : kNumbers);
}

}  // namespace ukemi::tools

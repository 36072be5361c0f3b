#include <fmt/format.h>

#include <cmath>

#include "landing/body/load.hpp"
#include "tools/report/body.hpp"
#include "tools/report/fall.hpp"
#include "tools/report/landing.hpp"
#include "tools/report/landing_doubts.hpp"
#include "tools/report/results.hpp"
#include "tools/report/scatter.hpp"
#include "tools/study/comparison.hpp"

namespace ukemi::tools {

const Outputs kCompareOutputs =
    Outputs{"compare", {"parameters.csv", "trajectories.csv"}, {"constants"}}.with(fall_figures());

using namespace landing;

namespace {

// --- what differs between the kinds of robot ---

/// The scene of the motions; null: none is given.
const Scene* scene_of(const Comparison& c) { return c.scene ? &*c.scene : nullptr; }
const BodyScene* scene_of(const BodyComparison& c) { return &c.scenes[1]; }

/// Peak of a landing with a set, or its largest load.
double worth_of(const Comparison&, std::size_t, const Landing& l) { return l.peak; }
double worth_of(const BodyComparison& c, std::size_t set, const BodyLanding& l) { return worth(c.scenes[set], l); }
bool rated_of(const Comparison&) { return false; }
bool rated_of(const BodyComparison& c) { return rated(c.scenes[1]); }

/// Doubts of a motion's landing with a set.
std::vector<std::string> doubts_of(const Comparison&, std::size_t, const Motion&, const Landing& l) {
  return landing_doubts(l);
}
std::vector<std::string> doubts_of(const BodyComparison& c, std::size_t set, const BodyMotion& m,
                                   const BodyLanding& l) {
  return landing_doubts(c.scenes[set], m, l);
}

/// Peaks of a plan with the identified constants.
const Distribution& truth_of(const ComparedPlan& p) { return p.truth.planned; }
const Distribution& truth_of(const ComparedBodyPlan& p) { return p.truth; }

/// Columns of trajectories.csv.
RowColumns<Sample> joint_columns(const Comparison&) {
  return {{"phi_1", "", &Sample::phi1}, {"phi_ref", "", &Sample::phi_ref}};
}
RowColumns<BodySample> joint_columns(const BodyComparison& c) {
  RowColumns<BodySample> out;
  const std::vector<Joint>& joints = c.scenes[0].robot.joints;
  for (std::size_t j = 0; j < joints.size(); ++j)
    if (joints[j].driven()) {
      out.push_back({"phi_" + joints[j].name, "", [j](auto& s) { return s.phi[j]; }});
      out.push_back({"phi_ref_" + joints[j].name, "", [j](auto& s) { return s.phi_ref[j]; }});
    }
  return out;
}

void show_falls(const Comparison& c, const std::vector<Fall>& falls, const std::string& data, Report& report) {
  show({*c.scene, c.sets[1], falls, {}, data}, report);
}
void show_falls(const BodyComparison& c, const std::vector<BodyFall>& falls, const std::string& data, Report& report) {
  show(c.scenes[1], falls, data, report);
}

struct ComparisonWords {
  const char *truth,  ///< the system with the identified constants
      *own,           ///< with what each motion is played in trajectories.csv
      *falls;         ///< what the falls are
};

// --- of any robot ---

template <class Of>
using SetOf = typename decltype(Of::motions)::value_type;
template <class Of>
using PlanOf = typename decltype(Of::plans)::value_type;

std::string signed_percent(double percent) { return fmt::format("{:+.1f} %", percent); }

Json inside(const ConstantDifference& c) { return c.inside() ? Json(*c.inside()) : Json(); }

const Quantities<ConstantDifference> kConstantQuantities = {
    {"parameter", "", "constant", {}, &ConstantDifference::name},
    {"unit", "", &ConstantDifference::unit},
    {"nominal", "nominal", "nominal", "{:.5g}", [](auto& c) { return c.value[0]; }},
    {"identified", "identified", "identified", "{:.5g}", [](auto& c) { return c.value[1]; }},
    {"difference", &ConstantDifference::difference},
    {"difference_percent", "difference_percent", "difference", signed_percent,
     [](auto& c) { return number(c.percent()); }},
    {"std", [](auto& c) { return number(c.std); }},
    {"z", "z", "in standard errors", "{:+.1f}", [](auto& c) { return number(c.z()); }},
    {"inside_ci95", "inside_ci95", "nominal inside the 95 % interval", {}, inside},
};

/// Columns of a trial: rms of its residual with each set.
Quantities<identify::Trial> residual_quantities(const Comparison& c) {
  const auto rms = [&c](std::size_t set) {
    return [&c, set](const identify::Trial& trial) {
      const auto m = std::size_t(&trial - c.measured->trials.data());
      const identify::TrialResult& t = (*c.predictions)[set].trials[m];
      return t.status == identify::RolloutStatus::kDone ? t.rms : NAN;
    };
  };
  return {
      {"", "file", "trial", {}, &identify::Trial::file},
      {"", "nominal", "nominal [rad]", "{:.4g}", rms(0)},
      {"", "identified", "identified [rad]", "{:.4g}", rms(1)},
  };
}

/// Columns of a set's best motion: its peak with each set.
template <class Of>
Quantities<SetOf<Of>> peak_quantities(const Of& c) {
  const auto peak = [&c](std::size_t set) -> Quantity<SetOf<Of>> {
    const bool rated = rated_of(c);
    return {"", kSets[set], fmt::format("{} with {} [{}]", goal_name(rated), kSets[set], goal_unit(rated)), "{:.5g}",
            [&c, set](auto& m) { return worth_of(c, set, *m.landings[set]); }};
  };
  const auto words = [&c](auto& m) {
    return fmt::format("best for {}: {}", m.set, motion_words(scene_of(c)->robot, m.best.motion));
  };
  return {{"", "", "motion", {}, words}, peak(0), peak(1)};
}

/// Columns of plans for scatter: promised value, and peaks with the identified constants as the truth.
template <class Of>
Quantities<PlanOf<Of>> plan_quantities(const Of& c) {
  Quantities<PlanOf<Of>> out = {
      {"", "set", "planned with", {}, &PlanOf<Of>::set},
      {"", "", "motion", {}, [&c](auto& p) { return motion_words(scene_of(c)->robot, p.best.motion); }},
      {"", "promised", fmt::format("promised [{}]", goal_unit(rated_of(c))), short_peak_words,
       [](auto& p) { return p.best.value; }}};
  append(out, "truth/", distribution_quantities(), [](auto& p) { return truth_of(p); });
  return out;
}

/// Warns of failed searches and landings, of doubts, and of a set for which the other set's motion is better than the
/// one that was searched for it.
template <class Of>
void warn_of_motions(const Of& c, Run& run) {
  constexpr double kSame = 1e-4;  // relative
  for (const SetOf<Of>& m : c.motions)
    if (!m.best.message.empty()) run.warn(m.set + ": " + m.best.message);
  for (const SetOf<Of>& m : c.motions)
    for (const auto& l : m.landings)
      if (l && no_landing(l->end)) run.warn(failure_words(*l, words_of(scene_of(c)->robot).contact));
  for (const SetOf<Of>& m : c.motions)
    for (std::size_t s = 0; s < 2; ++s)
      if (m.landings[s])
        warn_of(doubts_of(c, s, m.best.motion, *m.landings[s]), run, "best for " + m.set + ", with " + kSets[s] + ": ");
  for (std::size_t s = 0; s < 2 && c.landed(); ++s) {
    const double own = worth_of(c, s, *c.motions[s].landings[s]), other = worth_of(c, s, *c.motions[1 - s].landings[s]);
    if (other < (1 - kSame) * own)
      run.warn(
          fmt::format("the motion planned with the {} constants is better with the {} ones than their own: {:.4g}, "
                      "not {}; more --evaluations find better motions",
                      kSets[1 - s], kSets[s], other, goal_text(own, rated_of(c))));
  }
}

/// How much worse the plan of the nominal constants is on the system with the identified ones, `truth`.
template <class Of>
FirstScreen conclusion(const Of& c, const char* truth) {
  const auto& [of_nominal, of_identified] = std::tie(c.motions[0], c.motions[1]);
  const double best = worth_of(c, 1, *of_identified.landings[1]), nominal = worth_of(c, 1, *of_nominal.landings[1]),
               promised = worth_of(c, 0, *of_nominal.landings[0]);
  const bool rated = rated_of(c);
  const char* verb = rated ? "has" : "hits with";
  return {fmt::format("Planned with the nominal constants, {} {} {} where {:.4g} was promised: {:.2f} times the {} of "
                      "the motion planned with its own constants.",
                      truth, verb, goal_text(nominal, rated), promised, nominal / best, goal_text(best, rated)),
          {check(nominal <= kWorse * promised, "the nominal plan keeps its promise",
                 fmt::format("promised {}, {} {:.4g}", goal_text(promised, rated), verb, nominal)),
           check(nominal <= kWorse * best, "the nominal constants are good enough",
                 fmt::format("{:.2f} times the {} of the own plan", nominal / best, goal_name(rated)))},
          "`ukemi optimize` with the identified actuator plans the landing."};
}

template <class Of>
std::string trajectories_csv(const Of& c, const char* own, const Run& run) {
  CsvWriter csv = run.csv();
  csv.comment(fmt::format("Each set's best motion {}. t = 0 at release. Units: s, m/s^2, rad.", own));
  const auto joints = joint_columns(c);
  std::vector<std::string> names = {"set", "t", "acc"};
  for (const auto& column : joints) names.push_back(column.name);
  csv.header(names);
  for (std::size_t s = 0; s < 2; ++s)
    for (const auto& row : c.motions[s].landings[s]->trajectory) {
      csv.cell(kSets[s]).cell(row.t).cell(row.acc);
      for (const auto& column : joints) csv.cell(column.value(row));
      csv.end_row();
    }
  return csv.text();
}

void report_residuals(const Comparison& c, Json& summary, Report& report, const Run& run) {
  if (!c.predictions) return;
  const Table rows(residual_quantities(c), c.measured->trials);
  summary["residuals"] = rows.objects();
  run.say(fmt::format("residual rms over {} trials: nominal {:.4g} rad, identified {:.4g} rad",
                      c.measured->trials.size(), (*c.predictions)[0].rms, (*c.predictions)[1].rms));
  report.heading("Residuals on the trials, rms");
  report.table(rows);
}
void report_residuals(const BodyComparison&, Json&, Report&, const Run&) {}

/// Reports motions and plans and, where all landed, the peak of each motion with each set and the conclusion.
template <class Of>
void report_motions(const Of& c, const ComparisonWords& words, Json& summary, Report& report, Run& run) {
  const auto* scene = scene_of(c);
  for (const SetOf<Of>& m : c.motions) {
    if (!m.best.found) continue;
    summary["motions"][m.set] = motion_json(scene->robot, m.best.motion);
    if constexpr (requires { m.best.tolerant; })
      summary["tolerant_peaks"][m.set] = m.best.tolerant.complete ? number(m.best.tolerant.value) : Json();
  }
  if (!c.plans.empty()) {
    const Table plans(plan_quantities(c), c.plans);
    summary["plans"] = plans.objects();
    report.heading("Plans for scattered drops, where the identified constants are the truth");
    (void)add_table(plans, report, run);
  }
  if (!c.landed()) return;
  const Table peaks(peak_quantities(c), c.motions);
  for (std::size_t m = 0; m < 2; ++m) summary["peaks"][c.motions[m].set + "_motion"] = peaks.object(m);
  report.heading((rated_of(c) ? "Largest load" : "Peak " + words_of(scene->robot).acceleration) + " on " + scene->name);
  floor_source(report, source_of(*scene));
  (void)add_table(peaks, report, run);
  const FirstScreen screen = conclusion(c, words.truth);
  run.say(screen.sentence);
  report.answer(screen, run.warnings());
  run.add("trajectories.csv", trajectories_csv(c, words.own, run));
  show_falls(c,
             {{"planned with the identified constants", &*c.motions[1].landings[1]},
              {"planned with the nominal constants", &*c.motions[0].landings[1]}},
             std::string("trajectories.csv holds each motion ") + words.own, report);
  report.paragraph(std::string("Both falls above are ") + words.falls + ".");
}

/// The page without what is of the robot alone. `summary` holds what was read.
template <class Of>
Report comparison_page(const Of& c, const PerSet<std::string>& names, const ComparisonWords& words, Json& summary,
                       Run& run) {
  warn_of_motions(c, run);
  Report report("Identified against nominal");
  report.paragraph("nominal: " + names[0] + "; identified: " + names[1]);
  report.distrust(run.warnings());
  const Table constants(kConstantQuantities, c.constants);
  summary["parameters"] = constants.keyed();
  report.heading("Constants");
  (void)add_table(constants, report, run, "parameters.csv",
                  "z: difference in standard errors of the identified constant; inside_ci95: the nominal value inside "
                  "its 95 % interval.");
  report_residuals(c, summary, report, run);
  report_motions(c, words, summary, report, run);
  return report;
}

}  // namespace

int report(const Comparison& c, Json summary, Run& run) {
  for (std::size_t s = 0; s < 2 && c.predictions; ++s)
    if (const identify::Fit& fit = (*c.predictions)[s]; !fit.converged)
      run.warn(std::string(kSets[s]) + ": " + fit.message);
  comparison_page(c, {c.sets[0].name, c.sets[1].name},
                  {"the identified actuator", "under its own actuator",
                   "on the identified actuator, the one that stands for the real one"},
                  summary, run)
      .write(run);
  return run.finish(summary, c.complete ? kDone : kNumbers);
}

int report(const BodyComparison& c, const PerSet<std::string>& names, Run& run) {
  Json summary;
  Report report = comparison_page(c, names,
                                  {"the robot with the identified ones", "with its own drives",
                                   "with the identified constants, which stand for the real robot"},
                                  summary, run);
  robot_tables(c.scenes[1], report);
  report.write(run);
  return run.finish(summary, c.complete ? kDone : kNumbers);
}

}  // namespace ukemi::tools

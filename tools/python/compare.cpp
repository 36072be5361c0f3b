// Python bindings of comparisons of two sets of constants.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tools/python/arguments.hpp"
#include "tools/report/body.hpp"
#include "tools/report/results.hpp"
#include "tools/study/comparison.hpp"

namespace ukemi::python {

using namespace landing;
using tools::BodyComparison, tools::BodyComparisonOptions, tools::ComparedBodyMotion, tools::ComparedBodyPlan,
    tools::ComparedMotion, tools::ComparedPlan, tools::Comparison, tools::ConstantDifference, tools::PerSet;

namespace {

using ComparisonResult = Seeded<Comparison>;
using BodyCompared = Seeded<BodyComparison>;

/// Peaks of a motion by the set's name.
template <class Motion>
std::map<std::string, double> peaks_of(const Motion& m) {
  std::map<std::string, double> out;
  for (const std::size_t s : {0, 1})
    if (m.landings[s]) out[tools::kSets[s]] = m.landings[s]->peak;
  return out;
}

void bind_parts(py::module_& m) {
  Value<ConstantDifference> constant(m, "ConstantDifference", "A constant in both sets.");
  constant.def_readonly("name", &ConstantDifference::name, "Its name.")
      .def_readonly("unit", &ConstantDifference::unit, "Its unit.");
  property(constant, "nominal", "The nominal value [unit].", [](auto& d) { return d.value[0]; });
  property(constant, "identified", "The identified value [unit].", [](auto& d) { return d.value[1]; });
  property(constant, "difference", "identified - nominal [unit].", &ConstantDifference::difference);
  constant.def_readonly("std", &ConstantDifference::std, "Standard error of the identified one [unit], or None.");
  property(constant, "z", "The difference in standard errors [1], or None.", &ConstantDifference::z);
  constant.repr([](auto& d) { return fmt::format(" {}: {:.6g}, {:.6g} {}", d.name, d.value[0], d.value[1], d.unit); });
  Value<ComparedMotion> motion(m, "ComparedMotion", "The best motion of one set, landed under both.");
  motion.def_readonly("set", &ComparedMotion::set, "Whose best it is: nominal, identified.");
  property(motion, "motion", "The motion.", [](auto& c) { return PlannedMotion{c.best.motion, "peak", c.best.value}; });
  property(motion, "peaks", "Its peak under each set, by the set's name [m/s^2].", peaks_of<ComparedMotion>);
  Value<ComparedPlan> plan(m, "ComparedPlan", "A plan for drops that scatter, and what it comes to in truth.");
  plan.def_readonly("set", &ComparedPlan::set, "With what it was planned.");
  property(plan, "motion", "The motion, with what it promised.", [](auto& c) {
    return PlannedMotion{c.best.motion, "peak under scatter", c.best.value};
  });
  property(plan, "truth", "Its peaks where the identified constants are the truth [m/s^2].",
           [](auto& c) { return c.truth.planned; });
}

void bind_comparison(py::module_& m) {
  Value<ComparisonResult> c(m, "Comparison", "Identified against nominal constants.");
  property(c, "constants", "Each a ConstantDifference.", [](auto& r) { return r.result.constants; });
  property(c, "rms", "Residual of the trials for each set, by its name [rad]; empty without trials.", [](auto& r) {
    std::map<std::string, double> out;
    if (const auto& fits = r.result.predictions)
      for (const std::size_t s : {0, 1}) out[tools::kSets[s]] = (*fits)[s].rms;
    return out;
  });
  property(c, "motions", "With a scene: the best motion of each set.", [](auto& r) { return r.result.motions; });
  property(c, "plans", "With a measure: plans for drops that scatter.", [](auto& r) { return r.result.plans; });
  property(c, "complete", "Whether every rollout, search and landing worked out.",
           [](auto& r) { return r.result.complete; });
  bind_report(c, tools::kCompareOutputs, &ComparisonResult::seed,
              [](auto& r, tools::Run& run) { return report(r.result, {}, run); });
}

std::optional<tools::RigTrials> measured_of(const std::vector<identify::Trial>& trials,
                                            const std::optional<identify::Rig>& rig,
                                            const SeaParameters<double>& identified) {
  if (trials.empty() == rig.has_value()) throw InputError("trials, rig: both are needed, or none");
  if (!rig) return std::nullopt;
  return tools::RigTrials{*rig,
                          identify::with_nearer_force(*rig, prepared(trials, *rig, {}), rig->mounted(identified))};
}

/// Best motions of a set and their value; None where none was found.
py::dict best_of(const BodyCompared& c, const std::string& set, const BodyPlan& best) {
  py::dict out;
  out["set"] = set, out["value"] = best.found ? py::cast(best.value) : py::none();
  out["motions"] = best.found ? py::object(by_joint(c.result.scenes[0].robot, best.motion)) : py::none();
  return out;
}

py::list motions_of_sets(const BodyCompared& c) {
  return list_of(c.result.motions, [&](const ComparedBodyMotion& m) {
    py::dict motion = best_of(c, m.set, m.best);
    motion["peaks"] = peaks_of(m);
    return motion;
  });
}
py::list plans_of_sets(const BodyCompared& c) {
  return list_of(c.result.plans, [&](const ComparedBodyPlan& p) {
    py::dict plan = best_of(c, p.set, p.best);
    plan["truth"] = p.truth;
    return plan;
  });
}

/// Name of a set for the report.
std::string words_of(const BodyScene& scene) {
  return scene.drive_files.empty() ? scene.name : fmt::format("{}", fmt::join(scene.drive_files, ", "));
}

void bind_body_comparison(py::module_& m) {
  Value<BodyCompared> c(m, "RobotComparison", "A robot of links with identified against nominal drives.");
  property(c, "constants",
           "Of the drives that differ, of all where none does; each a ConstantDifference, named as k_p_JOINT.",
           [](auto& x) { return x.result.constants; });
  property(c, "motions",
           "The best motions of each set, landed under both: a dict of set, motions (by joint), value of the goal and "
           "peaks (by the set's name) [m/s^2]; None where none was found.",
           motions_of_sets);
  property(c, "plans",
           "With a measure, plans for drops that scatter: a dict of set, motions, value (what it promised [m/s^2]) and "
           "truth (a Distribution with the identified drives).",
           plans_of_sets);
  property(c, "complete", "Whether every search and landing worked out.", [](auto& x) { return x.result.complete; });
  c.repr([](auto& x) {
    return fmt::format(" of {} constants{}", x.result.constants.size(), x.result.complete ? "" : ", incomplete");
  });
  bind_report(c, tools::kCompareOutputs, &BodyCompared::seed, [](auto& x, tools::Run& run) {
    const PerSet<BodyScene>& scenes = x.result.scenes;
    return report(x.result, {words_of(scenes[0]), words_of(scenes[1])}, run);
  });
}

void bind_paper_compare(py::module_& m) {
  define(
      m, "compare",
      [](const Arguments& a, const Actuator& nominal, const Actuator& identified,
         const std::optional<landing::Scene>& scene, const std::vector<identify::Trial>& trials,
         const std::optional<identify::Rig>& rig) {
        require_gains(nominal), require_gains(identified);
        if (a.robust && !scene) throw InputError("robust: a scene is needed with it");
        tools::ComparisonOptions o;
        const long samples = o.robust.samples;
        o.robust = robust_of(a), o.robust.samples = samples;
        o.search.seed = a.seed, o.search.threads = a.threads;
        o.search.validate();
        const auto measured = measured_of(trials, rig, identified.sea);
        return long_call([&](const std::function<bool()>& stop) {
          o.monitor = [&stop](const std::string&) { return Monitor{{}, stop}; };
          return ComparisonResult{tools::compare({nominal, identified}, measured, scene, o), a.seed};
        });
      },
      py::arg("nominal"), py::arg("identified"), py::arg("scene") = py::none(),
      py::arg("trials") = std::vector<identify::Trial>{}, py::arg("rig") = py::none(), kRobust, kScatter, kInflate,
      kSeed, kThreads,
      "Identified against nominal constants, as `ukemi compare`: what differs; with trials and their rig how each set "
      "predicts them; with a scene the best motion of each under both; robust: plans for drops that scatter, too.");
}

void bind_body_compare(py::module_& m) {
  define(
      m, "compare",
      [](const Arguments& a, const BodyScene& nominal, const BodyScene& identified) {
        const PerSet<BodyScene> scenes = {nominal, identified};
        tools::check_sets(scenes);
        if (a.scatter && !a.robust) throw InputError("scatter: robust is needed with it");
        BodyComparisonOptions o{.search = plan_options(identified, a)};
        return long_call([&](const std::function<bool()>& stop) {
          o.monitor = [&stop](const std::string&) { return Monitor{{}, stop}; };
          return BodyCompared{compare(scenes, o), a.seed};
        });
      },
      py::arg("nominal"), py::arg("identified"), kEvaluations, kRobust, kScatter, kInflate, kSeed, kThreads,
      "The same of a robot of links: one scene read with the drives of each set, as read_robot_scene(path, {\"hip\": "
      "file}); evaluations: of each search.");
}

}  // namespace

void bind_compare(py::module_& m) {
  bind_parts(m), bind_comparison(m), bind_paper_compare(m), bind_body_comparison(m), bind_body_compare(m);
}

}  // namespace ukemi::python

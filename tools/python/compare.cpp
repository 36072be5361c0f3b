// Python bindings of comparisons of two sets of constants.
#include <fmt/format.h>

#include "tools/python/search.hpp"
#include "tools/python/trials.hpp"
#include "tools/report/results.hpp"
#include "tools/study/comparison.hpp"

namespace ukemi::python {

using tools::ComparedMotion, tools::ComparedPlan, tools::Comparison, tools::ConstantDifference, tools::PerSet;

namespace {

struct ComparisonResult {
  Comparison comparison;
  std::uint64_t seed = 1;
};

void bind_parts(py::module_& m) {
  py::class_<ConstantDifference> constant(m, "ConstantDifference", "A constant in both sets.");
  constant.def_readonly("name", &ConstantDifference::name, "Its name.")
      .def_readonly("unit", &ConstantDifference::unit, "Its unit.");
  property(constant, "nominal", "The nominal value [unit].", [](auto& d) { return d.value[0]; });
  property(constant, "identified", "The identified value [unit].", [](auto& d) { return d.value[1]; });
  property(constant, "difference", "identified - nominal [unit].", &ConstantDifference::difference);
  constant.def_readonly("std", &ConstantDifference::std, "Standard error of the identified one [unit], or None.");
  property(constant, "z", "The difference in standard errors [1], or None.", &ConstantDifference::z);
  constant.def("__repr__", [](const ConstantDifference& d) {
    return fmt::format("<ukemi.ConstantDifference {}: {:.6g}, {:.6g} {}>", d.name, d.value[0], d.value[1], d.unit);
  });
  bind_value(constant);
  py::class_<ComparedMotion> motion(m, "ComparedMotion", "The best motion of one set, landed under both.");
  motion.def_readonly("set", &ComparedMotion::set, "Whose best it is: nominal, identified.");
  property(motion, "motion", "The motion.", [](auto& c) { return PlannedMotion{c.best.motion, "peak", c.best.value}; });
  property(motion, "peaks", "Its peak under each set, by the set's name [m/s^2].", [](auto& c) {
    std::map<std::string, double> out;
    for (const std::size_t s : {0, 1})
      if (c.landings[s]) out[tools::kSets[s]] = c.landings[s]->peak;
    return out;
  });
  bind_value(motion);
  py::class_<ComparedPlan> plan(m, "ComparedPlan", "A plan for drops that scatter, and what it comes to in truth.");
  plan.def_readonly("set", &ComparedPlan::set, "With what it was planned.");
  property(plan, "motion", "The motion, with what it promised.", [](auto& c) {
    return PlannedMotion{c.best.motion, "peak under scatter", c.best.value};
  });
  property(plan, "truth", "Its peaks where the identified constants are the truth [m/s^2].",
           [](auto& c) { return c.truth.planned; });
  bind_value(plan);
}

void bind_comparison(py::module_& m) {
  py::class_<ComparisonResult> c(m, "Comparison", "Identified against nominal constants.");
  property(c, "constants", "Each a ConstantDifference.", [](auto& r) { return r.comparison.constants; });
  property(c, "rms", "Residual of the trials for each set, by its name [rad]; empty without trials.", [](auto& r) {
    std::map<std::string, double> out;
    if (const auto& fits = r.comparison.predictions)
      for (const std::size_t s : {0, 1}) out[tools::kSets[s]] = (*fits)[s].rms;
    return out;
  });
  property(c, "motions", "With a scene: the best motion of each set.", [](auto& r) { return r.comparison.motions; });
  property(c, "plans", "With a measure: plans for drops that scatter.", [](auto& r) { return r.comparison.plans; });
  property(c, "complete", "Whether every rollout, search and landing worked out.",
           [](auto& r) { return r.comparison.complete; });
  bind_value(c);
  bind_report(c, tools::kCompareOutputs, &ComparisonResult::seed,
              [](auto& r, tools::Run& run) { return report(r.comparison, {}, run); });
}

std::optional<tools::RigTrials> measured_of(const std::vector<identify::Trial>& trials,
                                            const std::optional<identify::Rig>& rig,
                                            const SeaParameters<double>& identified) {
  if (trials.empty() == rig.has_value()) throw InputError("trials, rig: both are needed, or none");
  if (!rig) return std::nullopt;
  return tools::RigTrials{*rig,
                          identify::with_nearer_force(*rig, prepared(trials, *rig, {}), rig->mounted(identified))};
}

}  // namespace

void bind_compare(py::module_& m) {
  bind_parts(m), bind_comparison(m);
  m.def(
      "compare",
      [](const Actuator& nominal, const Actuator& identified, const std::optional<landing::Scene>& scene,
         const std::vector<identify::Trial>& trials, const std::optional<identify::Rig>& rig,
         const std::optional<std::string>& robust, const std::optional<std::string>& scatter, double inflate,
         std::uint64_t seed, int threads) {
        require_gains(nominal), require_gains(identified);
        if (robust && !scene) throw InputError("robust: a scene is needed with it");
        tools::ComparisonOptions o;
        o.robust = robust_of(robust, scatter, inflate, o.robust.samples);
        o.search.seed = seed, o.search.threads = threads;
        o.search.validate();
        const auto measured = measured_of(trials, rig, identified.sea);
        return long_call([&](const std::function<bool()>& stop) {
          o.monitor = [&stop](const std::string&) { return Monitor{{}, stop}; };
          return ComparisonResult{tools::compare({nominal, identified}, measured, scene, o), seed};
        });
      },
      py::arg("nominal"), py::arg("identified"), py::arg("scene") = py::none(),
      py::arg("trials") = std::vector<identify::Trial>{}, py::arg("rig") = py::none(), py::arg("robust") = py::none(),
      py::arg("scatter") = py::none(), py::arg("inflate") = 1.0, py::arg("seed") = 1, py::arg("threads") = 0,
      "Identified against nominal constants, as `ukemi compare`: what differs; with trials and their rig how each set "
      "predicts them; with a scene the best motion of each under both; robust: plans for drops that scatter, too.");
}

}  // namespace ukemi::python

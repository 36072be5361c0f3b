// Python bindings of comparisons of two sets of drive constants of a robot of links.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tools/python/body.hpp"
#include "tools/python/search.hpp"
#include "tools/report/body.hpp"
#include "tools/report/results.hpp"

namespace ukemi::python {

using namespace landing;
using tools::BodyComparison, tools::BodyComparisonOptions, tools::ComparedBodyMotion, tools::ComparedBodyPlan,
    tools::PerSet;

namespace {

struct BodyCompared {
  BodyComparison comparison;
  std::uint64_t seed = 1;
};

/// Best motions of a set and their value; None where none was found.
py::dict best_of(const BodyCompared& c, const std::string& set, const BodyPlan& best) {
  py::dict out;
  out["set"] = set, out["value"] = best.found ? py::cast(best.value) : py::none();
  out["motions"] = best.found ? py::object(by_joint(c.comparison.scenes[0].robot, best.motion)) : py::none();
  return out;
}

py::list motions_of_sets(const BodyCompared& c) {
  py::list out;
  for (const ComparedBodyMotion& m : c.comparison.motions) {
    py::dict motion = best_of(c, m.set, m.best), peaks;
    for (const std::size_t s : {0, 1})
      if (m.landings[s]) peaks[tools::kSets[s]] = m.landings[s]->peak;
    motion["peaks"] = peaks;
    out.append(motion);
  }
  return out;
}
py::list plans_of_sets(const BodyCompared& c) {
  py::list out;
  for (const ComparedBodyPlan& p : c.comparison.plans) {
    py::dict plan = best_of(c, p.set, p.best);
    plan["truth"] = p.truth;
    out.append(plan);
  }
  return out;
}

/// Name of a set for the report.
std::string words_of(const BodyScene& scene) {
  return scene.drive_files.empty() ? scene.name : fmt::format("{}", fmt::join(scene.drive_files, ", "));
}

void bind_body_comparison(py::module_& m) {
  py::class_<BodyCompared> c(m, "RobotComparison", "A robot of links with identified against nominal drives.");
  property(c, "constants",
           "Of the drives that differ, of all where none does; each a ConstantDifference, named as k_p_JOINT.",
           [](auto& x) { return x.comparison.constants; });
  property(c, "motions",
           "The best motions of each set, landed under both: a dict of set, motions (by joint), value of the goal and "
           "peaks (by the set's name) [m/s^2]; None where none was found.",
           motions_of_sets);
  property(c, "plans",
           "With a measure, plans for drops that scatter: a dict of set, motions, value (what it promised [m/s^2]) and "
           "truth (a Distribution with the identified drives).",
           plans_of_sets);
  property(c, "complete", "Whether every search and landing worked out.",
           [](auto& x) { return x.comparison.complete; });
  c.def("__repr__", [](const BodyCompared& x) {
    return fmt::format("<ukemi.RobotComparison of {} constants{}>", x.comparison.constants.size(),
                       x.comparison.complete ? "" : ", incomplete");
  });
  bind_value(c);
  bind_report(c, tools::kCompareOutputs, &BodyCompared::seed, [](auto& x, tools::Run& run) {
    const PerSet<BodyScene>& scenes = x.comparison.scenes;
    return report(x.comparison, {words_of(scenes[0]), words_of(scenes[1])}, run);
  });
}

}  // namespace

void bind_body_compare(py::module_& m) {
  bind_body_comparison(m);
  m.def(
      "compare",
      [](const BodyScene& nominal, const BodyScene& identified, std::optional<long> evaluations,
         const std::optional<std::string>& robust, const std::optional<std::string>& scatter, double inflate,
         std::uint64_t seed, int threads) {
        const PerSet<BodyScene> scenes = {nominal, identified};
        tools::check_sets(scenes);
        if (scatter && !robust) throw InputError("scatter: robust is needed with it");
        BodyComparisonOptions o;
        o.search =
            plan_options(identified, seed, "peak", evaluations, robust, scatter, inflate, o.search.samples, threads);
        return long_call([&](const std::function<bool()>& stop) {
          o.monitor = [&stop](const std::string&) { return Monitor{{}, stop}; };
          return BodyCompared{compare(scenes, o), seed};
        });
      },
      py::arg("nominal"), py::arg("identified"), py::arg("evaluations") = py::none(), py::arg("robust") = py::none(),
      py::arg("scatter") = py::none(), py::arg("inflate") = 1.0, py::arg("seed") = 1, py::arg("threads") = 0,
      "The same of a robot of links: one scene read with the drives of each set, as read_robot_scene(path, {\"hip\": "
      "file}); evaluations: of each search.");
}

}  // namespace ukemi::python

// Python bindings of maps of robots of links.
#include "landing/plan/body_map.hpp"

#include <fmt/format.h>

#include <variant>

#include "tools/python/body.hpp"
#include "tools/python/mapped.hpp"
#include "tools/report/body.hpp"
#include "tools/report/results.hpp"

namespace ukemi::python {

using namespace landing;

namespace {

/// A survey and its seed.
struct BodyMap {
  BodySurvey survey;
  std::uint64_t seed = 1;
};

py::dict mapped_motion(const BodyMap& m, const BodyMotion& motion, double peak) {
  py::dict out;
  out["motions"] = by_joint(m.survey.scene.robot, motion), out["peak"] = peak;
  return out;
}

void bind_body_survey(py::module_& m) {
  py::class_<BodyMap> c(m, "RobotMap", "The motions of a robot of links on a grid over some of their variables.");
  bind_mapped(
      c, [](auto& x) -> auto& { return x.survey; });
  property(c, "broken", "Landings that broke a limit of the scene.", [](auto& x) { return x.survey.broken; });
  property(
      c, "minima",
      "The grid's best local minima, the best first: a dict of motions (by joint) and peak, in the unit of `peak`.",
      [](auto& x) {
        py::list out;
        for (const GridMinimum& g : x.survey.minima) out.append(mapped_motion(x, g.motion, g.peak));
        return out;
      });
  property(c, "basins",
           "What was found from there over all variables, the best first: a dict of motions, peak and tolerant_peak "
           "(infinite: one of its drops could not be followed or breaks a limit).",
           [](auto& x) {
             py::list out;
             for (const BodyBasin& b : x.survey.basins) {
               py::dict basin = mapped_motion(x, b.motion, b.peak);
               basin["tolerant_peak"] = b.tolerant;
               out.append(basin);
             }
             return out;
           });
  c.def("__repr__", [](const BodyMap& x) {
    return fmt::format("<ukemi.RobotMap: {} landings, {} basins>", x.survey.map.grid.size(), x.survey.basins.size());
  });
  bind_value(c);
  bind_report(c, tools::kMapOutputs, &BodyMap::seed, [](auto& x, tools::Run& run) { return report(x.survey, run); });
}

/// Varied variables by name, or with their numbers of points.
using Vary = std::variant<std::vector<std::string>, std::map<std::string, double>>;
std::vector<GridAxis> grid_of(const Vary& vary) {
  std::vector<GridAxis> out;
  if (const auto* names = std::get_if<0>(&vary))
    for (const std::string& name : *names) out.push_back({name, {}});
  else
    for (const auto& [name, points] : std::get<1>(vary)) out.push_back({name, points});
  return out;
}

}  // namespace

void bind_body_map(py::module_& m) {
  bind_body_survey(m);
  m.def(
      "map",
      [](const BodyScene& scene, const Vary& vary, const std::optional<JointMotions>& slice, int polish,
         std::uint64_t seed, int threads) {
        const BodySpace space(scene);
        SurveyOptions options;
        MapOptions& map = options.map;
        map.cells = cells_of(space, grid_of(vary), "vary");
        map.slice = slice ? slice_of(space, scene, motions_of(scene, *slice), {"slice"}) : held_slice(space, scene);
        map.polished = polish, map.seed = seed, map.threads = threads;
        map.validate();
        return long_call([&](const std::function<bool()>& stop) {
          map.monitor.stop = options.basins.stop = stop;
          return BodyMap{survey(scene, options), seed};
        });
      },
      py::arg("scene"), py::arg("vary"), py::arg("slice") = py::none(), py::arg("polish") = MapOptions().polished,
      py::arg("seed") = 1, py::arg("threads") = 0,
      "The same of a robot of links. vary: one to three variables by name, as [\"phi_i_hip\", \"phi_f_knee\"], or a "
      "dict with the points of each; slice: motions by joint, where the others stand (None: the held posture).");
}

}  // namespace ukemi::python

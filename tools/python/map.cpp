// Python bindings of maps and of motor ratings.
#include <fmt/format.h>

#include <variant>

#include "landing/judge/speed.hpp"
#include "landing/plan/body_map.hpp"
#include "tools/python/landing.hpp"
#include "tools/report/body.hpp"
#include "tools/report/results.hpp"

namespace ukemi::python {

using namespace landing;

namespace {

/// Indices of the varied variables.
std::vector<int> varied(const PeakMap& map) {
  std::vector<int> out;
  for (int k = 0; k < int(map.cells.size()); ++k)
    if (map.cells[std::size_t(k)] > 1) out.push_back(k);
  return out;
}

/// View of the peaks with an axis for each varied variable; `owner` keeps them alive.
py::array_t<double> peaks_view(const PeakMap& map, py::handle owner) {
  std::vector<py::ssize_t> shape, strides;
  py::ssize_t step = sizeof(PeakMap::Cell);
  for (std::size_t k = map.cells.size(); k-- > 0; step *= map.cells[k])
    if (map.cells[k] > 1) shape.insert(shape.begin(), map.cells[k]), strides.insert(strides.begin(), step);
  py::array_t<double> out(shape, strides, &map.grid.front().peak, owner);
  out.attr("setflags")(false);
  return out;
}

/// The grid's values of each varied variable by name.
py::dict axes_of(const PeakMap& map) {
  py::dict out;
  for (const int k : varied(map)) {
    std::vector<double> values;
    for (int i = 0; i < map.cells[std::size_t(k)]; ++i) values.push_back(map.coordinate(k, i));
    out[py::str(map.variables[std::size_t(k)].name)] = py::array_t<double>(py::ssize_t(values.size()), values.data());
  }
  return out;
}

/// The smallest peak over varied variables number x and y.
Figure map_figure(const PeakMap& map, int x, int y) {
  const std::vector<int> axes = varied(map);
  const int n = int(axes.size());
  if (n == 1) {
    const tools::Heatmap line = tools::projection(map, axes[0], axes[0]);
    tools::Series peaks{"", line.x, {}};
    for (const PeakMap::Cell& c : map.grid) peaks.y.push_back(c.peak);
    return {tools::lines_svg(line.x_label, "peak [m/s^2]", {peaks})};
  }
  if (x < 0 || y < 0 || x >= n || y >= n || x == y)
    throw InputError(fmt::format("x, y: {}, {}: two of the axes 0 to {} are needed", x, y, n - 1));
  return {tools::Report("").heatmap(tools::projection(map, axes[std::size_t(x)], axes[std::size_t(y)]))};
}

/// Binds what maps of both kinds of robot tell; of(x): the peaks.
template <class T, class Of, class... Options>
void bind_mapped(py::class_<T, Options...>& c, Of of) {
  c.def_property_readonly(
      "peak", [of](const py::object& self) { return peaks_view(of(self.cast<const T&>()).map, self); },
      "Peaks [m/s^2], of a robot with loads the largest value / rating [1], an axis for each of `axes`; NaN where a "
      "landing could not be followed or breaks a limit.");
  property(c, "axes", "The grid's values along each variable that has a grid, by its name [rad, s or 1].",
           [of](auto& x) { return axes_of(of(x).map); });
  property(c, "failed", "Landings that could not be followed.", [of](auto& x) { return of(x).failed; });
  property(c, "joint_lost", "Landings whose drive lost the joint.", [of](auto& x) { return of(x).lost; });
  c.def(
       "figure", [of](const T& r, int x, int y) { return map_figure(of(r).map, x, y); }, py::arg("x") = 0,
       py::arg("y") = 1, "The smallest peak [m/s^2] over the variables that are not drawn; x, y: indices of `axes`.")
      .def(
          "_repr_svg_", [of](const T& x) { return map_figure(of(x).map, 0, 1).svg; }, "What a notebook shows.");
}

using SurveyResult = Seeded<Survey>;
using BodyMap = Seeded<BodySurvey>;

void bind_basin(py::module_& m) {
  Value<JudgedBasin> c(m, "Basin", "The best motion found near a local minimum of a map.");
  property(c, "motion", "The motion.", [](auto& b) { return b.basin.play.motion; });
  property(c, "peak", "Its peak [m/s^2].", [](auto& b) { return b.basin.peak; });
  property(c, "tolerant_peak", "The worst peak within the scene's execution tolerance [m/s^2].",
           [](auto& b) { return b.evidence.tolerant.value; });
}

void bind_survey(py::module_& m) {
  Value<SurveyResult> c(m, "Map", "The box of motions on a grid, and its basins.");
  bind_mapped(
      c, [](auto& r) -> auto& { return r.result; });
  property(c, "basins", "The distinct basins, the best first.", [](auto& r) { return r.result.basins; });
  bind_report(c, tools::kMapOutputs);
}

void bind_map_call(py::module_& m) {
  define(
      m, "map",
      [](const Arguments& a, const Scene& scene, const Actuator& actuator, const std::vector<int>& grid, int polish) {
        require_gains(actuator);
        const ReferenceSpace space(scene, actuator.sea);
        if (grid.size() < kPaperVariables || int(grid.size()) > space.dimension())
          throw InputError(fmt::format("grid: {} numbers: {} to {} are needed", grid.size(), int(kPaperVariables),
                                       space.dimension()));
        SurveyOptions options;
        MapOptions& map = options.map;
        map.cells = grid, map.polished = polish, map.seed = a.seed, map.threads = a.threads;
        map.validate();
        const auto find = [&] { return survey(scene, space, options); };
        return SurveyResult{monitored(find, map.monitor, options.basins, options.evidence), a.seed};
      },
      py::arg("scene"), py::arg("actuator"), py::arg("grid") = MapOptions().cells,
      py::arg("polish") = MapOptions().polished, kSeed, kThreads,
      "The whole box of motions on a grid, as `ukemi map`. grid: points of phi_i, phi_f, duration and, if the motion "
      "has more, those.");
}

py::dict mapped_motion(const BodyMap& m, const BodyMotion& motion, double peak) {
  py::dict out;
  out["motions"] = by_joint(m.result.scene.robot, motion), out["peak"] = peak;
  return out;
}

void bind_body_survey(py::module_& m) {
  Value<BodyMap> c(m, "RobotMap", "The motions of a robot of links on a grid over some of their variables.");
  bind_mapped(
      c, [](auto& x) -> auto& { return x.result; });
  property(c, "broken", "Landings that broke a limit of the scene.", [](auto& x) { return x.result.broken; });
  property(
      c, "minima",
      "The grid's best local minima, the best first: a dict of motions (by joint) and peak, in the unit of `peak`.",
      [](auto& x) {
        return list_of(x.result.minima, [&](const GridMinimum& g) { return mapped_motion(x, g.motion, g.peak); });
      });
  property(c, "basins",
           "What was found from there over all variables, the best first: a dict of motions, peak and tolerant_peak "
           "(infinite: one of its drops could not be followed or breaks a limit).",
           [](auto& x) {
             return list_of(x.result.basins, [&](const BodyBasin& b) {
               py::dict basin = mapped_motion(x, b.motion, b.peak);
               basin["tolerant_peak"] = b.tolerant;
               return basin;
             });
           });
  c.repr([](auto& x) {
    return fmt::format(": {} landings, {} basins", x.result.map.grid.size(), x.result.basins.size());
  });
  bind_report(c, tools::kMapOutputs);
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

void bind_body_map(py::module_& m) {
  define(
      m, "map",
      [](const Arguments& a, const BodyScene& scene, const Vary& vary, const std::optional<JointMotions>& slice,
         int polish) {
        const BodySpace space(scene);
        SurveyOptions options;
        MapOptions& map = options.map;
        map.cells = cells_of(space, grid_of(vary), "vary");
        map.slice = slice ? slice_of(space, scene, motions_of(scene, *slice), {"slice"}) : held_slice(space, scene);
        map.polished = polish, map.seed = a.seed, map.threads = a.threads;
        map.validate();
        return BodyMap{monitored([&] { return survey(scene, options); }, map.monitor, options.basins), a.seed};
      },
      py::arg("scene"), py::arg("vary"), py::arg("slice") = py::none(), py::arg("polish") = MapOptions().polished,
      kSeed, kThreads,
      "The same of a robot of links. vary: one to three variables by name, as [\"phi_i_hip\", \"phi_f_knee\"], or a "
      "dict with the points of each; slice: motions by joint, where the others stand (None: the held posture).");
}

/// The rated plans and their inputs.
struct RatingsResult {
  Scene scene;
  std::vector<RatedPlan> plans;
  std::uint64_t seed = 1;
};

std::vector<double> rising(const std::string& what, const Numbers& numbers) {
  std::vector<double> out = column(what, numbers);
  for (std::size_t i = 0; i < out.size(); ++i) {
    checked(what, out[i], Range::positive());
    if (i > 0 && !(out[i] > out[i - 1])) throw InputError(fmt::format("{}[{}]: {}: must rise", what, i, out[i]));
  }
  if (out.empty()) throw InputError(what + ": at least one is needed");
  return out;
}

RatingsResult rated(const Arguments& a, const Scene& scene, const Actuator& actuator, const Numbers& speeds,
                    const std::optional<Numbers>& torques) {
  require_gains(actuator);
  RatingOptions options;
  options.speeds = rising("motor_speeds", speeds);
  options.torques = torques ? rising("motor_torques", *torques)
                            : std::vector{actuator.motor_torque_max.value_or(std::numeric_limits<double>::infinity())};
  options.search.evaluations = a.evaluations, options.search.seed = a.seed, options.search.threads = a.threads;
  options.search.tolerance_samples = 0;
  options.search.validate();
  const auto find = [&] { return rated_plans(scene, actuator, options); };
  return {scene, monitored(find, options.search.monitor), a.seed};
}

void bind_ratings(py::module_& m) {
  Value<RatedPlan> plan(m, "RatedPlan", "The best motions of a motor with these ratings.");
  const auto motion = [](const Optimum& o, const char* goal) -> std::optional<PlannedMotion> {
    return o.found ? std::optional(PlannedMotion{o.motion, goal, o.value}) : std::nullopt;
  };
  plan.def_readonly("motor_speed", &RatedPlan::speed, "Rated speed of the motor [rad/s].")
      .def_readonly("motor_torque", &RatedPlan::torque, "Rated torque of the motor [Nm]; infinite: no limit.");
  property(plan, "lowest", "The motion with the smallest peak, or None.",
           [motion](auto& p) { return motion(p.lowest, "peak"); });
  property(plan, "tolerant", "The motion with the smallest tolerant peak, or None.",
           [motion](auto& p) { return motion(p.tolerant, "tolerant peak"); });
  plan.repr([](auto& p) {
    return fmt::format(" {:.4g} rad/s, {:.4g} Nm: {}, {}", p.speed, p.torque, minimised("peak", p.lowest.value),
                       minimised("tolerant peak", p.tolerant.value));
  });
  Value<RatingsResult> c(m, "Ratings", "What speed buys: the best peaks against the motor's ratings.");
  c.def_readonly("plans", &RatingsResult::plans, "Every torque at every speed, speeds first; each a RatedPlan.");
  bind_report(c, tools::kRatingsOutputs, &RatingsResult::seed,
              [](auto& r, tools::Run& run) { return report(r.scene, r.plans, run); });
  define(
      m, "ratings", &rated, py::arg("scene"), py::arg("actuator"), py::arg("motor_speeds"),
      py::arg("motor_torques") = py::none(), kEvaluations, kSeed, kThreads,
      "The best peaks against the motor's ratings, as `ukemi ratings`. motor_speeds [rad/s], motor_torques [Nm]: each "
      "rising; None: the actuator's motor_torque_max, else no limit; evaluations: motions tried in each search.");
}

}  // namespace

void bind_map(py::module_& m) {
  bind_basin(m), bind_survey(m), bind_map_call(m), bind_body_survey(m), bind_body_map(m), bind_ratings(m);
}

}  // namespace ukemi::python

// Python bindings of maps and of motor ratings.
#include <fmt/format.h>

#include "landing/judge/speed.hpp"
#include "landing/judge/survey.hpp"
#include "tools/python/mapped.hpp"
#include "tools/report/results.hpp"

namespace ukemi::python {

using namespace landing;

std::vector<int> varied(const PeakMap& map) {
  std::vector<int> out;
  for (int k = 0; k < int(map.cells.size()); ++k)
    if (map.cells[std::size_t(k)] > 1) out.push_back(k);
  return out;
}

py::array_t<double> peaks_view(const PeakMap& map, py::handle owner) {
  std::vector<py::ssize_t> shape, strides;
  py::ssize_t step = sizeof(PeakMap::Cell);
  for (std::size_t k = map.cells.size(); k-- > 0; step *= map.cells[k])
    if (map.cells[k] > 1) shape.insert(shape.begin(), map.cells[k]), strides.insert(strides.begin(), step);
  py::array_t<double> out(shape, strides, &map.grid.front().peak, owner);
  out.attr("setflags")(false);
  return out;
}

py::dict axes_of(const PeakMap& map) {
  py::dict out;
  for (const int k : varied(map)) {
    std::vector<double> values;
    for (int i = 0; i < map.cells[std::size_t(k)]; ++i) values.push_back(map.coordinate(k, i));
    out[py::str(map.variables[std::size_t(k)].name)] = py::array_t<double>(py::ssize_t(values.size()), values.data());
  }
  return out;
}

Figure figure(const PeakMap& map, int x, int y) {
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

namespace {

/// A survey and its seed.
struct SurveyResult {
  Survey survey;
  std::uint64_t seed = 1;
};

void bind_basin(py::module_& m) {
  py::class_<JudgedBasin> c(m, "Basin", "The best motion found near a local minimum of a map.");
  property(c, "motion", "The motion.", [](auto& b) { return b.basin.play.motion; });
  property(c, "peak", "Its peak [m/s^2].", [](auto& b) { return b.basin.peak; });
  property(c, "tolerant_peak", "The worst peak within the scene's execution tolerance [m/s^2].",
           [](auto& b) { return b.evidence.tolerant.value; });
  bind_value(c);
}

void bind_survey(py::module_& m) {
  py::class_<SurveyResult> c(m, "Map", "The box of motions on a grid, and its basins.");
  bind_mapped(
      c, [](auto& r) -> auto& { return r.survey; });
  property(c, "basins", "The distinct basins, the best first.", [](auto& r) { return r.survey.basins; });
  bind_value(c);
  bind_report(c, tools::kMapOutputs, &SurveyResult::seed,
              [](auto& r, tools::Run& run) { return report(r.survey, run); });
}

void bind_map_call(py::module_& m) {
  m.def(
      "map",
      [](const Scene& scene, const Actuator& actuator, const std::vector<int>& grid, int polish, std::uint64_t seed,
         int threads) {
        require_gains(actuator);
        const ReferenceSpace space(scene, actuator.sea);
        if (grid.size() < kPaperVariables || int(grid.size()) > space.dimension())
          throw InputError(fmt::format("grid: {} numbers: {} to {} are needed", grid.size(), int(kPaperVariables),
                                       space.dimension()));
        SurveyOptions options;
        options.map.cells = grid, options.map.polished = polish, options.map.seed = seed, options.map.threads = threads;
        options.map.validate();
        return long_call([&](const std::function<bool()>& stop) {
          options.map.monitor.stop = options.basins.stop = options.evidence.stop = stop;
          return SurveyResult{survey(scene, space, options), seed};
        });
      },
      py::arg("scene"), py::arg("actuator"), py::arg("grid") = MapOptions().cells,
      py::arg("polish") = MapOptions().polished, py::arg("seed") = 1, py::arg("threads") = 0,
      "The whole box of motions on a grid, as `ukemi map`. grid: points of phi_i, phi_f, duration and, if the motion "
      "has more, those.");
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

RatingsResult rated(const Scene& scene, const Actuator& actuator, const Numbers& speeds,
                    const std::optional<Numbers>& torques, std::optional<long> evaluations, std::uint64_t seed,
                    int threads) {
  require_gains(actuator);
  RatingOptions options;
  options.speeds = rising("motor_speeds", speeds);
  options.torques = torques ? rising("motor_torques", *torques)
                            : std::vector{actuator.motor_torque_max.value_or(std::numeric_limits<double>::infinity())};
  options.search.evaluations = evaluations, options.search.seed = seed, options.search.threads = threads;
  options.search.tolerance_samples = 0;
  options.search.validate();
  return long_call([&](const std::function<bool()>& stop) {
    options.search.monitor.stop = stop;
    RatingsResult out{scene, rated_plans(scene, actuator, options), seed};
    return out;
  });
}

void bind_ratings(py::module_& m) {
  py::class_<RatedPlan> plan(m, "RatedPlan", "The best motions of a motor with these ratings.");
  const auto motion = [](const Optimum& o, const char* goal) -> std::optional<PlannedMotion> {
    return o.found ? std::optional(PlannedMotion{o.motion, goal, o.value}) : std::nullopt;
  };
  plan.def_readonly("motor_speed", &RatedPlan::speed, "Rated speed of the motor [rad/s].")
      .def_readonly("motor_torque", &RatedPlan::torque, "Rated torque of the motor [Nm]; infinite: no limit.");
  property(plan, "lowest", "The motion with the smallest peak, or None.",
           [motion](auto& p) { return motion(p.lowest, "peak"); });
  property(plan, "tolerant", "The motion with the smallest tolerant peak, or None.",
           [motion](auto& p) { return motion(p.tolerant, "tolerant peak"); });
  plan.def("__repr__", [](const RatedPlan& p) {
    return fmt::format("<ukemi.RatedPlan {:.4g} rad/s, {:.4g} Nm: {}, {}>", p.speed, p.torque,
                       minimised("peak", p.lowest.value), minimised("tolerant peak", p.tolerant.value));
  });
  bind_value(plan);
  py::class_<RatingsResult> c(m, "Ratings", "What speed buys: the best peaks against the motor's ratings.");
  c.def_readonly("plans", &RatingsResult::plans, "Every torque at every speed, speeds first; each a RatedPlan.");
  bind_value(c);
  bind_report(c, tools::kRatingsOutputs, &RatingsResult::seed,
              [](auto& r, tools::Run& run) { return report(r.scene, r.plans, run); });
  m.def(
      "ratings", &rated, py::arg("scene"), py::arg("actuator"), py::arg("motor_speeds"),
      py::arg("motor_torques") = py::none(), py::arg("evaluations") = py::none(), py::arg("seed") = 1,
      py::arg("threads") = 0,
      "The best peaks against the motor's ratings, as `ukemi ratings`. motor_speeds [rad/s], motor_torques [Nm]: each "
      "rising; None: the actuator's motor_torque_max, else no limit; evaluations: motions tried in each search.");
}

}  // namespace

void bind_map(py::module_& m) { bind_basin(m), bind_survey(m), bind_map_call(m), bind_ratings(m); }

}  // namespace ukemi::python

// The best motion, its risk, the map and the planner for Python.
#include <fmt/format.h>

#include <mutex>

#include "landing/judge/answer.hpp"
#include "landing/judge/risk.hpp"
#include "landing/judge/survey.hpp"
#include "landing/model/scatter_file.hpp"
#include "landing/model/scene_file.hpp"
#include "landing/search/planner.hpp"
#include "tools/program/arguments.hpp"
#include "tools/python/landing.hpp"
#include "tools/report/landing.hpp"

namespace ukemi::python {

using namespace landing;

namespace {

Goal goal_of(const std::string& text) {
  return tools::choice<Goal>("objective", text, {{"peak", Goal::kPeak}, {"tolerant", Goal::kTolerant}});
}
/// The scatter of an argument, else the scene's, else what is assumed.
Scatter scatter_of(const std::optional<std::string>& text, const Scene& scene) {
  return scatter_for(text ? std::optional(parse_scatter("scatter", *text)) : std::nullopt, scene);
}
double inflation(double inflate) { return checked("inflate", inflate, {0, 100, false, "0 to 100"}); }

struct Asked {
  std::string objective, solver;
  std::optional<long> evaluations;
  std::optional<double> deadline;
  std::vector<std::string> forbid;
  bool respect_ratings;
  std::optional<std::string> robust, scatter;
  double inflate;
  long samples;
  double rate;
  std::uint64_t seed;
  int threads;
};
AnswerOptions options_of(const Asked& a, const Actuator& actuator) {
  require_gains(actuator);
  AnswerOptions out;
  OptimizeOptions& o = out.search;
  o.solver = a.solver, o.goal = goal_of(a.objective), o.evaluations = a.evaluations, o.deadline = a.deadline;
  o.limits.forbidden = points_of(a.forbid);
  o.seed = a.seed, o.threads = a.threads;
  if (a.respect_ratings) respect_ratings(actuator, o);
  o.validate();
  out.rate = checked("rate", a.rate, {0, 1e6, true, "above 0 to 1e6 Hz"});
  if (a.robust) out.robust.measure = Measure::parse("robust", *a.robust);
  if (a.scatter) out.robust.scatter = parse_scatter("scatter", *a.scatter);
  out.robust.inflate = inflation(a.inflate);
  out.robust.samples = long(checked("samples", double(a.samples), {16, 4096, false, "16 to 4096"}));
  return out;
}

Answer optimized(const Scene& scene, const Actuator& actuator, const Asked& asked) {
  AnswerOptions options = options_of(asked, actuator);
  return long_call([&](const std::function<bool()>& stop) {
    options.search.monitor.stop = options.evidence_monitor.stop = stop;
    Answer out = answer(scene, actuator, options);
    out.options.search.monitor = out.options.evidence_monitor = {};
    return out;
  });
}

std::map<std::string, std::string> edges_of(const std::vector<Variable>& variables, const Edges& edges) {
  std::map<std::string, std::string> out;
  for (std::size_t k = 0; k < variables.size(); ++k)
    if (edges[k] != 0) out[variables[k].name] = edges[k] < 0 ? "lower" : "upper";
  return out;
}

void bind_answer(py::module_& m) {
  py::class_<Answer>(m, "Optimum", "The best motion that was found, its landing beside that of the held reference.")
      .def_property_readonly(
          "found", [](const Answer& a) { return a.best.found; },
          "Whether any motion could be followed within the limits.")
      .def_property_readonly(
          "message", [](const Answer& a) { return a.best.message; },
          "Why nothing was found, or why the search ended before all was spent.")
      .def_property_readonly(
          "motion", [](const Answer& a) { return a.best.motion; }, "The best motion.")
      .def_property_readonly("peak", &Answer::peak, "Its largest |ddr_0| [m/s^2].")
      .def_property_readonly(
          "tolerant_peak",
          [](const Answer& a) { return a.tolerant_known ? std::optional(a.best.tolerant.value) : std::nullopt; },
          "The worst peak within the scene's execution tolerance [m/s^2], or None where it was not played.")
      .def_property_readonly(
          "edges",
          [](const Answer& a) {
            const ReferenceSpace space(a.scene, a.best.sea);
            return edges_of(space.variables(), a.best.edges);
          },
          "Variables that lie on an edge of their search range, by name: \"lower\" or \"upper\".")
      .def_property_readonly(
          "held_deg", [](const Answer& a) { return a.best.held->motion.phi_i * kDegrees; },
          "The best posture to hold that the search found [deg].")
      .def_property_readonly("held_peak", &Answer::held_peak, "Of the reference held there [m/s^2].")
      .def_property_readonly("reduction", &Answer::reduction, "1 - peak / held_peak [1].")
      .def_property_readonly(
          "value", [](const Answer& a) { return a.best.value; },
          "What was minimised: the peak, the tolerant peak, or the measure under scatter [m/s^2].")
      .def_property_readonly(
          "evaluations", [](const Answer& a) { return a.best.evaluations; }, "Motions that were searched.")
      .def_property_readonly(
          "seconds", [](const Answer& a) { return a.best.seconds; }, "That the search took [s].")
      .def_property_readonly(
          "solver", [](const Answer& a) { return a.best.solver; }, "That found it.")
      .def_property_readonly(
          "landing",
          [](const Answer& a) {
            return Played{a.landing, {}};
          },
          "The landing of the motion.")
      .def_property_readonly(
          "held",
          [](const Answer& a) {
            return Played{a.held, {}};
          },
          "The landing of the held reference.")
      .def(
          "figure",
          [](const Answer& a) {
            return figure({{"best motion", &a.landing}, {"held", &a.held}});
          },
          "|ddr_0| [m/s^2] over time [s] of the motion and of the held reference.")
      .def(
          "_repr_svg_",
          [](const Answer& a) {
            return figure({{"best motion", &a.landing}, {"held", &a.held}}).svg;
          },
          "What a notebook shows.")
      .def("__repr__", [](const Answer& a) {
        return a.best.found
                   ? fmt::format("<ukemi.Optimum: {}; peak {:.6g} m/s^2>", tools::motion_words(a.best.motion), a.peak())
                   : "<ukemi.Optimum: " + a.best.message + ">";
      });
}

void bind_optimize(py::module_& m) {
  m.def(
      "optimize",
      [](const Scene& scene, const Actuator& actuator, std::uint64_t seed, const std::string& objective,
         const std::string& solver, std::optional<long> evaluations, std::optional<double> deadline,
         const std::vector<std::string>& forbid, bool respect_ratings, const std::optional<std::string>& robust,
         const std::optional<std::string>& scatter, double inflate, long samples, double rate, int threads) {
        return optimized(scene, actuator,
                         {objective, solver, evaluations, deadline, forbid, respect_ratings, robust, scatter, inflate,
                          samples, rate, seed, threads});
      },
      py::arg("scene"), py::arg("actuator"), py::arg("seed") = 1, py::arg("objective") = "peak",
      py::arg("solver") = "auto", py::arg("evaluations") = py::none(), py::arg("deadline") = py::none(),
      py::arg("forbid") = std::vector<std::string>{}, py::arg("respect_ratings") = false,
      py::arg("robust") = py::none(), py::arg("scatter") = py::none(), py::arg("inflate") = 1.0,
      py::arg("samples") = RobustOptions().samples, py::arg("rate") = 1000.0, py::arg("threads") = 0,
      "The knee motion with the smallest peak acceleration of the thigh (Eq. 6), as `ukemi optimize`. objective: peak "
      "or "
      "tolerant; deadline [s] from the call; forbid: of hip, knee, foot; robust: mean, cvar, quantile:Q or worst, over "
      "drops "
      "that scatter as the text scatter says (\"pitch_deg=1,height=0.01\"); rate: rows of the trajectories a second "
      "[Hz].");
}

void bind_distribution(py::module_& m) {
  py::class_<Estimated>(m, "Estimated", "A value with the standard error that it has from the number of drops.")
      .def_readonly("value", &Estimated::value, "The value [m/s^2].")
      .def_readonly("standard_error", &Estimated::standard_error, "Its standard error [m/s^2].")
      .def("__float__", [](const Estimated& e) { return e.value; })
      .def("__repr__", [](const Estimated& e) {
        return fmt::format("<ukemi.Estimated {:.6g} +- {:.2g}>", e.value, e.standard_error);
      });
  py::class_<Distribution>(m, "Distribution", "Peaks over scattered drops.")
      .def_readonly("mean", &Distribution::mean, "Mean peak [m/s^2].")
      .def_readonly("cvar90", &Distribution::cvar90, "Mean of the worst tenth [m/s^2].")
      .def_readonly("median", &Distribution::median, "Half of the peaks are below [m/s^2].")
      .def_readonly("q90", &Distribution::q90, "90 % of the peaks are below [m/s^2].")
      .def_readonly("q99", &Distribution::q99, "99 % of the peaks are below [m/s^2].")
      .def_readonly("max", &Distribution::max, "The largest peak [m/s^2].")
      .def_readonly("samples", &Distribution::samples, "Drops.");
}

void bind_risk(py::module_& m) {
  bind_distribution(m);
  py::class_<Risk>(m, "Risk", "The peaks of a motion over drops that scatter, and what scatters them.")
      .def_readonly("peaks", &Risk::peaks, "Of the motion [m/s^2].")
      .def_readonly("held", &Risk::held, "Of the reference held at -45 deg over the same drops [m/s^2].")
      .def_readonly("failed", &Risk::failed, "Landings that could not be followed to the floor.")
      .def_readonly("joint_lost", &Risk::lost, "Of the others, those whose drive lost the joint.")
      .def_readonly("from_floor", &Risk::from_floor, "Drops that would begin below the floor: they begin on it.")
      .def_property_readonly(
          "histogram",
          [](const Risk& r) {
            std::vector<double> edges, drops;
            for (const PeakBin& b : r.histogram) edges.push_back(b.lower), drops.push_back(double(b.drops));
            if (!r.histogram.empty()) edges.push_back(r.histogram.back().upper);
            return std::pair(py::array_t<double>(py::ssize_t(drops.size()), drops.data()),
                             py::array_t<double>(py::ssize_t(edges.size()), edges.data()));
          },
          "Drops with a peak in each bin, and the bins' edges [m/s^2], as numpy.histogram gives them.")
      .def_property_readonly(
          "uncertainties",
          [](const Risk& r) {
            std::map<std::string, std::pair<double, double>> out;
            for (const Risk::Uncertainty& u : r.uncertainties) out[u.name] = {u.index.first.value, u.index.total.value};
            return out;
          },
          "Sobol's indices of each group of numbers that scatter: first order and total [1].");
  m.def(
      "risk",
      [](const Scene& scene, const Actuator& actuator, const Motion& motion, const std::optional<std::string>& scatter,
         double inflate, bool inexact, long samples, const std::vector<std::string>& forbid, std::uint64_t seed,
         int threads) {
        require_gains(actuator);
        RiskOptions options{.samples = samples, .forbidden = points_of(forbid), .seed = seed, .threads = threads};
        options.validate();
        const DropModel model(scene, scatter_of(scatter, scene), actuator,
                              {.inflate = inflation(inflate), .inexact = inexact});
        return long_call([&](const std::function<bool()>& stop) {
          options.monitor.stop = stop;
          return risk(model, actuator, motion, options);
        });
      },
      py::arg("scene"), py::arg("actuator"), py::arg("motion"), py::arg("scatter") = py::none(),
      py::arg("inflate") = 1.0, py::arg("inexact") = false, py::arg("samples") = RiskOptions().samples,
      py::arg("forbid") = std::vector<std::string>{}, py::arg("seed") = 1, py::arg("threads") = 0,
      "Plays a motion over drops that scatter, as `ukemi risk`. scatter: \"pitch_deg=1,height=0.01\", None: the "
      "scene's, else "
      "1 deg, 1 cm, 3 cm/s; inflate: factor of the standard errors of the actuator's constants [1].");
}

std::vector<double> axis(const PeakMap& map, int variable) {
  std::vector<double> out;
  for (int i = 0; i < map.cells[std::size_t(variable)]; ++i) out.push_back(map.coordinate(variable, i));
  return out;
}

Figure map_figure(const Survey& s, int x, int y) {
  const int n = int(s.map.cells.size());
  if (x < 0 || y < 0 || x >= n || y >= n || x == y)
    throw InputError(fmt::format("x, y: {}, {}: two of the variables 0 to {} are needed", x, y, n - 1));
  return {tools::Report("").heatmap(tools::projection(s.map, x, y))};
}

void bind_map(py::module_& m) {
  py::class_<JudgedBasin>(m, "Basin", "The best motion found near a local minimum of a map.")
      .def_property_readonly(
          "motion", [](const JudgedBasin& b) { return b.basin.play.motion; }, "The motion.")
      .def_property_readonly(
          "peak", [](const JudgedBasin& b) { return b.basin.peak; }, "Its peak [m/s^2].")
      .def_property_readonly(
          "tolerant_peak", [](const JudgedBasin& b) { return b.evidence.tolerant.value; },
          "The worst peak within the scene's execution tolerance [m/s^2].");
  py::class_<Survey>(m, "Map", "The box of motions on a grid, and its basins.")
      .def_property_readonly(
          "peak",
          [](const py::object& self) {
            const PeakMap& map = self.cast<const Survey&>().map;
            std::vector<py::ssize_t> shape(map.cells.begin(), map.cells.end()), strides(shape.size());
            py::ssize_t step = sizeof(PeakMap::Cell);
            for (std::size_t k = shape.size(); k-- > 0; step *= shape[k]) strides[k] = step;
            py::array_t<double> out(shape, strides, &map.grid.front().peak, self);
            out.attr("setflags")(false);
            return out;
          },
          "Peaks [m/s^2], an axis for each variable; NaN where a landing could not be followed.")
      .def_property_readonly(
          "axes",
          [](const Survey& s) {
            py::dict out;
            for (std::size_t k = 0; k < s.map.variables.size(); ++k) {
              const std::vector<double> values = axis(s.map, int(k));
              out[py::str(s.map.variables[k].name)] = py::array_t<double>(py::ssize_t(values.size()), values.data());
            }
            return out;
          },
          "The grid's values along each variable by its name [rad, s or 1].")
      .def_readonly("basins", &Survey::basins, "The distinct basins, the best first.")
      .def_readonly("failed", &Survey::failed, "Landings that could not be followed.")
      .def_readonly("joint_lost", &Survey::lost, "Landings whose drive lost the joint.")
      .def("figure", &map_figure, py::arg("x") = 0, py::arg("y") = 1,
           "The smallest peak [m/s^2] over the variables that are not drawn.")
      .def(
          "_repr_svg_", [](const Survey& s) { return map_figure(s, 0, 1).svg; }, "What a notebook shows.");
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
          return survey(scene, space, options);
        });
      },
      py::arg("scene"), py::arg("actuator"), py::arg("grid") = MapOptions().cells,
      py::arg("polish") = MapOptions().polished, py::arg("seed") = 1, py::arg("threads") = 0,
      "The whole box of motions on a grid, as `ukemi map`. grid: points of phi_i, phi_f, duration and, if the motion "
      "has "
      "more, those.");
}

/// A planner that is asked by one thread at a time, whatever Python's do.
class PythonPlanner {
 public:
  PythonPlanner(const Scene& scene, const Actuator& actuator, const Planner::Options& options)
      : planner_(scene, (require_gains(actuator), actuator.sea), options) {}

  template <class State>
  Plan plan(const State& state, double deadline, std::uint64_t seed) {
    const std::unique_lock lock(asked_, std::try_to_lock);
    if (!lock) throw std::runtime_error("the planner is asked by another thread already");
    const py::gil_scoped_release release;
    return planner_.plan(state, deadline, seed);
  }

 private:
  Planner planner_;
  std::mutex asked_;
};

Planner::Options planner_options(const Scene& scene, const Actuator& actuator, const std::string& objective,
                                 const std::vector<std::string>& forbid, bool ratings,
                                 const std::optional<std::string>& robust, const std::optional<std::string>& scatter) {
  OptimizeOptions limits;
  limits.limits.forbidden = points_of(forbid);
  if (ratings) respect_ratings(actuator, limits);
  Planner::Options out{.goal = goal_of(objective), .limits = limits.limits};
  if (robust) {
    out.goal = Goal::kRobust;
    out.under_scatter.measure = Measure::parse("robust", *robust);
    out.under_scatter.scatter = scatter_of(scatter, scene);
  }
  return out;
}

void bind_planner(py::module_& m) {
  py::class_<Plan>(m, "Plan", "What a planner answers with.")
      .def_property_readonly("found", &Plan::found, "Whether there is a motion: status is found.")
      .def_property_readonly(
          "status", [](const Plan& p) { return name(p.status); },
          "found; nothing: nothing could be followed within the limits in the time given; floor_first: the floor comes "
          "before the deadline; bad_input: `wrong` says which number cannot be.")
      .def_readonly("wrong", &Plan::wrong, "With bad_input: the number and its rule.")
      .def_readonly("motion", &Plan::motion, "The motion.")
      .def_readonly("value", &Plan::value, "The goal [m/s^2].")
      .def_readonly("motions", &Plan::motions, "Evaluated.");
  py::class_<PythonPlanner>(m, "Planner",
                            "The search as a part of a control program: an answer by a deadline, again and again.")
      .def(py::init([](const Scene& scene, const Actuator& actuator, const std::string& objective,
                       const std::vector<std::string>& forbid, bool ratings, const std::optional<std::string>& robust,
                       const std::optional<std::string>& scatter) {
             return std::make_unique<PythonPlanner>(
                 scene, actuator, planner_options(scene, actuator, objective, forbid, ratings, robust, scatter));
           }),
           "Arguments as of `optimize`; all memory is taken here.", py::arg("scene"), py::arg("actuator"),
           py::arg("objective") = "tolerant", py::arg("forbid") = std::vector<std::string>{},
           py::arg("respect_ratings") = false, py::arg("robust") = py::none(), py::arg("scatter") = py::none())
      .def(
          "plan",
          [](PythonPlanner& p, double height, double forward_speed, double pitch_deg, double pitch_rate_deg,
             double deadline, std::uint64_t seed) {
            return p.plan(Drop{height, forward_speed, pitch_deg / kDegrees, pitch_rate_deg / kDegrees}, deadline, seed);
          },
          py::arg("height"), py::arg("forward_speed") = 0.0, py::arg("pitch_deg") = 0.0,
          py::arg("pitch_rate_deg") = 0.0, py::arg("deadline") = 0.1, py::arg("seed") = 1,
          "The best motion for a drop by the deadline [s]: height [m], forward_speed [m/s], pitch_deg [deg], "
          "pitch_rate_deg "
          "[deg/s].")
      .def(
          "plan_in_air",
          [](PythonPlanner& p, double height, double forward_speed, double pitch_deg, double pitch_rate_deg,
             double phi_deg, double rate_deg, double gone, std::optional<double> vertical_speed, double deadline,
             std::uint64_t seed) {
            return p.plan(FallState{height, forward_speed, pitch_deg / kDegrees, pitch_rate_deg / kDegrees,
                                    phi_deg / kDegrees, rate_deg / kDegrees, gone, vertical_speed},
                          deadline, seed);
          },
          py::arg("height"), py::arg("forward_speed"), py::arg("pitch_deg"), py::arg("pitch_rate_deg"),
          py::arg("phi_deg"), py::arg("rate_deg") = 0.0, py::arg("gone") = 0.0, py::arg("vertical_speed") = py::none(),
          py::arg("deadline") = 0.02, py::arg("seed") = 1,
          "The same for a robot that falls already: its clearance height [m], joint angle phi_deg [deg] and rate_deg "
          "[deg/s], "
          "the time gone since release [s] or vertical_speed [m/s], upwards. The scene must have a [release].");
}

}  // namespace

void bind_search(py::module_& m) { bind_answer(m), bind_optimize(m), bind_risk(m), bind_map(m), bind_planner(m); }

}  // namespace ukemi::python

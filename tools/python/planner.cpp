// Python bindings of the planner of a control program.
#include <fmt/format.h>

#include "landing/search/planner.hpp"
#include "tools/python/search.hpp"
#include "tools/report/scatter.hpp"

namespace ukemi::python {

using namespace landing;

namespace {

/// A plan with the name of its goal.
struct NamedPlan {
  Plan plan;
  std::string goal;
};

/// A planner that throws if a second thread uses it meanwhile.
class PythonPlanner {
 public:
  PythonPlanner(const Scene& scene, const Actuator& actuator, const Planner::Options& options)
      : planner_(scene, (require_gains(actuator), actuator.sea), options),
        goal_(options.goal == Goal::kRobust ? tools::goal_words(Goal::kPeak, options.under_scatter.measure)
                                            : tools::goal_words(options.goal, {})) {}

  template <class State>
  NamedPlan plan(const State& state, double deadline, std::uint64_t seed) {
    return {alone(mutex_, "planner", [&] { return planner_.plan(state, deadline, seed); }), goal_};
  }

 private:
  Planner planner_;
  std::string goal_;
  std::mutex mutex_;
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
    out.under_scatter.scatter = scatter_for(parsed_scatter(scatter), scene);
  }
  return out;
}

void bind_plan(py::module_& m) {
  py::class_<NamedPlan> c(m, "Plan", "What a planner answers with.");
  property(c, "found", "Whether there is a motion: status is found.", [](auto& p) { return p.plan.found(); });
  property(c, "status",
           "found; nothing: nothing could be followed within the limits in the time given; floor_first: the floor "
           "comes before the deadline; bad_input: `wrong` says which number cannot be.",
           [](auto& p) { return name(p.plan.status); });
  property(c, "wrong", "With bad_input: the number and its rule.", [](auto& p) { return p.plan.wrong; });
  property(c, "motion", "The motion, with what it minimised.", [](auto& p) {
    return PlannedMotion{p.plan.motion, p.goal, p.plan.value};
  });
  c.def_readonly("goal", &NamedPlan::goal, "What was minimised.");
  property(c, "value", "Of the goal [m/s^2].", [](auto& p) { return p.plan.value; });
  property(c, "motions", "Evaluated.", [](auto& p) { return p.plan.motions; });
  c.def("__repr__", [](const NamedPlan& p) {
    if (!p.plan.found()) return fmt::format("<ukemi.Plan: {} {}>", name(p.plan.status), p.plan.wrong);
    return fmt::format("<ukemi.Plan: {}; {}>", tools::motion_words(p.plan.motion), minimised(p.goal, p.plan.value));
  });
  bind_value(c);
}

}  // namespace

void bind_planner(py::module_& m) {
  bind_plan(m);
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
          "pitch_rate_deg [deg/s].")
      .def(
          "plan_in_air",
          [](PythonPlanner& p, double height, double forward_speed, double pitch_deg, double pitch_rate_deg,
             double phi_deg, double rate_deg, double elapsed, std::optional<double> vertical_speed, double deadline,
             std::uint64_t seed) {
            return p.plan(FallState{height, forward_speed, pitch_deg / kDegrees, pitch_rate_deg / kDegrees,
                                    phi_deg / kDegrees, rate_deg / kDegrees, elapsed, vertical_speed},
                          deadline, seed);
          },
          py::arg("height"), py::arg("forward_speed"), py::arg("pitch_deg"), py::arg("pitch_rate_deg"),
          py::arg("phi_deg"), py::arg("rate_deg") = 0.0, py::arg("elapsed") = 0.0,
          py::arg("vertical_speed") = py::none(), py::arg("deadline") = 0.02, py::arg("seed") = 1,
          "The same for a robot that falls already: its clearance height [m], joint angle phi_deg [deg] and rate_deg "
          "[deg/s], the time since release [s] or vertical_speed [m/s], upwards. The scene must have a [release].");
}

}  // namespace ukemi::python

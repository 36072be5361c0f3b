// Python bindings of the planners of a control program.
#include "landing/search/planner.hpp"

#include <fmt/format.h>

#include "landing/plan/body_planner.hpp"
#include "tools/python/arguments.hpp"
#include "tools/report/body.hpp"
#include "tools/report/scatter.hpp"

namespace ukemi::python {

using namespace landing;

namespace {

using NamedPlan = WithGoal<Plan>;
using PythonPlanner = Asked<Planner, Scene>;
using PythonBodyPlanner = Asked<BodyPlanner, BodyScene>;

/// The answer for a drop or for a state in the air.
template <class State>
NamedPlan answer_of(PythonPlanner& p, const State& state, double deadline, std::uint64_t seed) {
  return {p.ask([&](Planner& x) { return x.plan(state, deadline, seed); }), p.goal};
}
/// The same of a robot of links, as a dict.
template <class State>
py::dict answer_of(PythonBodyPlanner& p, const State& state, double deadline, std::uint64_t seed) {
  const BodyAnswer a = p.ask([&](BodyPlanner& x) { return x.plan(state, deadline, seed); });
  py::dict out;
  out["status"] = name(a.status), out["found"] = a.found(), out["wrong"] = a.wrong;
  out["motions"] = a.found() ? py::object(by_joint(p.scene.robot, a.plan.motion)) : py::none();
  out["goal"] = p.goal, out["value"] = a.found() ? py::cast(a.plan.value) : py::none();
  out["held_value"] = a.found() ? py::cast(a.plan.held_value) : py::none();
  out["loads"] = a.found() ? py::object(loads_of_landing(p.scene, a.plan.landing)) : py::none();
  return out;
}

Planner::Options planner_options(const Arguments& a, const Scene& scene, const Actuator& actuator) {
  OptimizeOptions limits;
  limits.limits.forbidden = points_of(a.forbid);
  if (a.respect_ratings) respect_ratings(actuator, limits);
  Planner::Options out{.goal = goal_of(a.objective), .limits = limits.limits};
  if (a.robust) {
    out.goal = Goal::kRobust;
    out.under_scatter.measure = Measure::parse("robust", *a.robust);
    out.under_scatter.scatter = scatter_for(parsed_scatter(a.scatter), scene);
  }
  return out;
}

void bind_plan(py::module_& m) {
  Value<NamedPlan> c(m, "Plan", "What a planner answers with.");
  property(c, "found", "Whether there is a motion: status is found.", [](auto& p) { return p.answer.found(); });
  property(c, "status",
           "found; nothing: nothing could be followed within the limits in the time given; floor_first: the floor "
           "comes before the deadline; bad_input: `wrong` says which number cannot be.",
           [](auto& p) { return name(p.answer.status); });
  property(c, "wrong", "With bad_input: the number and its rule.", [](auto& p) { return p.answer.wrong; });
  property(c, "motion", "The motion, with what it minimised.", [](auto& p) {
    return PlannedMotion{p.answer.motion, p.goal, p.answer.value};
  });
  c.def_readonly("goal", &NamedPlan::goal, "What was minimised.");
  property(c, "value", "Of the goal [m/s^2].", [](auto& p) { return p.answer.value; });
  property(c, "motions", "Evaluated.", [](auto& p) { return p.answer.motions; });
  c.def("__repr__", [](const NamedPlan& p) {
    if (!p.answer.found()) return fmt::format("<ukemi.Plan: {} {}>", name(p.answer.status), p.answer.wrong);
    return fmt::format("<ukemi.Plan: {}; {}>", tools::motion_words(p.answer.motion), minimised(p.goal, p.answer.value));
  });
}

void bind_paper_planner(py::module_& m) {
  py::class_<PythonPlanner> c(m, "Planner",
                              "The search as a part of a control program: an answer by a deadline, again and again.");
  define_constructor(
      c,
      [](const Arguments& a, const Scene& scene, const Actuator& actuator) {
        const Planner::Options options = planner_options(a, scene, actuator);
        require_gains(actuator);
        const std::string goal = options.goal == Goal::kRobust
                                     ? tools::goal_words(Goal::kPeak, options.under_scatter.measure)
                                     : tools::goal_words(options.goal, {});
        return std::make_unique<PythonPlanner>("planner", scene, goal, scene, actuator.sea, options);
      },
      "Arguments as of `optimize`; all memory is taken here.", py::arg("scene"), py::arg("actuator"),
      kObjective.with("tolerant"), kForbid, kRespectRatings, kRobust, kScatter);
  c.def(
       "plan",
       [](PythonPlanner& p, double height, double forward_speed, double pitch_deg, double pitch_rate_deg,
          double deadline, std::uint64_t seed) {
         const Drop drop{height, forward_speed, pitch_deg / kDegrees, pitch_rate_deg / kDegrees};
         return answer_of(p, drop, deadline, seed);
       },
       py::arg("height"), py::arg("forward_speed") = 0.0, py::arg("pitch_deg") = 0.0, py::arg("pitch_rate_deg") = 0.0,
       py::arg("deadline") = 0.1, py::arg("seed") = 1,
       "The best motion for a drop by the deadline [s]: height [m], forward_speed [m/s], pitch_deg [deg], "
       "pitch_rate_deg [deg/s].")
      .def(
          "plan_in_air",
          [](PythonPlanner& p, double height, double forward_speed, double pitch_deg, double pitch_rate_deg,
             double phi_deg, double rate_deg, double elapsed, std::optional<double> vertical_speed, double deadline,
             std::uint64_t seed) {
            const FallState state{height,
                                  forward_speed,
                                  pitch_deg / kDegrees,
                                  pitch_rate_deg / kDegrees,
                                  phi_deg / kDegrees,
                                  rate_deg / kDegrees,
                                  elapsed,
                                  vertical_speed};
            return answer_of(p, state, deadline, seed);
          },
          py::arg("height"), py::arg("forward_speed"), py::arg("pitch_deg"), py::arg("pitch_rate_deg"),
          py::arg("phi_deg"), py::arg("rate_deg") = 0.0, py::arg("elapsed") = 0.0,
          py::arg("vertical_speed") = py::none(), py::arg("deadline") = 0.02, py::arg("seed") = 1,
          "The same for a robot that falls already: its clearance height [m], joint angle phi_deg [deg] and rate_deg "
          "[deg/s], the time since release [s] or vertical_speed [m/s], upwards. The scene must have a [release].");
}

using JointStates = std::map<std::string, std::pair<double, double>>;  ///< angle [rad] and rate [rad/s] by name
std::vector<BodyRelease::Joint> joints_of(const Robot& robot, const JointStates& joints) {
  std::vector<BodyRelease::Joint> out;
  std::size_t named = 0;
  for (const Joint& j : robot.joints) {
    const auto at = joints.find(j.name);
    if (j.driven() && at == joints.end()) throw InputError("joints: " + j.name + ": its (angle, rate) is missing");
    named += at != joints.end();
    out.push_back(at == joints.end() ? BodyRelease::Joint{j.phi, 0}
                                     : BodyRelease::Joint{at->second.first, at->second.second});
  }
  if (named != joints.size()) throw InputError("joints: a name that is no joint of this robot");
  return out;
}

struct InAir : BodyFallState {
  double deadline = 0.05;
  std::uint64_t seed = 1;
};

void bind_body_planner(py::module_& m) {
  py::class_<PythonBodyPlanner> c(m, "RobotPlanner", "The planner of a control program of a robot of links.");
  define_constructor(
      c,
      [](const Arguments& a, const BodyScene& scene) {
        const BodyScene limited = with_limits(scene, a);
        const BodyPlanOptions options{.goal = goal_of(a.objective), .threads = a.threads};
        return std::make_unique<PythonBodyPlanner>("planner", limited, tools::goal_words(options.goal, options.measure),
                                                   limited, options);
      },
      py::arg("scene"), kObjective.with("tolerant"), kForbid, kRespectRatings, kThreads);
  c.def(
      "plan",
      [](PythonBodyPlanner& p, double height, double forward_speed, double pitch, double pitch_rate, double deadline,
         std::uint64_t seed) {
        return answer_of(p, Drop{height, forward_speed, pitch, pitch_rate}, deadline, seed);
      },
      py::arg("height"), py::arg("forward_speed") = 0.0, py::arg("pitch") = 0.0, py::arg("pitch_rate") = 0.0,
      py::arg("deadline") = 0.1, py::arg("seed") = 1,
      "The best motions for a drop from rest by the deadline [s]: a dict of status, found, wrong, motions (by "
      "joint), goal, value and held_value [m/s^2], loads as RobotLanding.loads. height [m], forward_speed [m/s], "
      "pitch [rad], pitch_rate [rad/s].");
  define(
      c, "plan_in_air",
      [](InAir a, PythonBodyPlanner& p, double height, const JointStates& joints) {
        a.height = height, a.joints = joints_of(p.scene.robot, joints);
        return answer_of<BodyFallState>(p, a, a.deadline, a.seed);
      },
      py::arg("height"), py::arg("joints"), Argument{"forward_speed", &InAir::forward_speed},
      Argument{"pitch", &InAir::pitch}, Argument{"pitch_rate", &InAir::pitch_rate},
      Argument{"elapsed", &InAir::elapsed}, Argument{"vertical_speed", &InAir::vertical_speed},
      Argument{"deadline", &InAir::deadline}, Argument{"seed", &InAir::seed},
      "The same for a robot that falls already: joints is a dict of (angle [rad], rate [rad/s]) of each driven "
      "joint, elapsed: the time since release [s], vertical_speed upwards [m/s].");
}

}  // namespace

void bind_planner(py::module_& m) { bind_plan(m), bind_paper_planner(m), bind_body_planner(m); }

}  // namespace ukemi::python

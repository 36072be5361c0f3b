// Python bindings of plans and risk of robots of links.
#include <fmt/format.h>

#include "common/error.hpp"
#include "landing/plan/body_drop_file.hpp"
#include "landing/plan/body_planner.hpp"
#include "tools/python/body.hpp"
#include "tools/python/search.hpp"
#include "tools/report/body.hpp"
#include "tools/report/results.hpp"
#include "tools/report/scatter.hpp"

namespace ukemi::python {

using namespace landing;

namespace {

/// The drops of a file; null without one.
std::shared_ptr<const std::vector<BodyDrop>> measured_drops(const std::optional<Path>& file, const BodyScene& scene,
                                                            const std::optional<std::string>& scatter, double inflate) {
  if (!file) return nullptr;
  check_measured(scatter, inflate);
  return std::make_shared<const std::vector<BodyDrop>>(read_drops(*file, scene));
}

struct BodyOptimum {
  BodyScene scene;
  BodyPlan plan;
  BodyPlanOptions options;

  std::string goal() const { return tools::goal_words(options.goal, options.measure); }
};
struct BodyRiskResult {
  BodyScene scene;
  BodyMotion motion;
  BodyRisk risk;
  BodyRiskOptions options;
};

void bind_body_optimum(py::module_& m) {
  py::class_<BodyOptimum> c(m, "RobotOptimum", "The best motions of a robot of links beside the held posture.");
  const auto played = [](const BodyOptimum& o, const BodyMotion& motion, const BodyLanding& landing) {
    return BodyPlayed{
        {.scene = o.scene, .motion = motion, .landing = landing, .sensitivity = {}, .accuracy = o.options.accuracy},
        o.options.rate};
  };
  property(c, "found", "Whether anything could be followed to the floor.", [](auto& o) { return o.plan.found; });
  property(c, "message", "Why nothing was found, or why the search ended early.",
           [](auto& o) { return o.plan.message; });
  property(c, "motions", "The best motion of each driven joint by its name.",
           [](auto& o) { return by_joint(o.scene.robot, o.plan.motion); });
  property(c, "goal", "What was minimised.", &BodyOptimum::goal);
  property(c, "value", "Of the goal [m/s^2].", [](auto& o) { return o.plan.value; });
  property(c, "held_value", "The same of the held posture [m/s^2].", [](auto& o) { return o.plan.held_value; });
  property(c, "peak", "Peak of the scene's own drop [m/s^2].", [](auto& o) { return o.plan.landing.peak; });
  property(c, "held_peak", "The same of the held posture [m/s^2].", [](auto& o) { return o.plan.held.peak; });
  property(c, "edges", "Variables that lie on an edge of their search range, by name: \"lower\" or \"upper\".",
           [](auto& o) { return edges_of(o.plan.variables, o.plan.edges); });
  property(c, "evaluations", "Motions that were searched, under scatter landings.",
           [](auto& o) { return o.plan.evaluations; });
  property(c, "seconds", "From the call to the answer [s].", [](auto& o) { return o.plan.seconds; });
  property(c, "landing", "The landing of the motions.",
           [played](auto& o) { return played(o, o.plan.motion, o.plan.landing); });
  property(c, "held", "The landing of the held posture.",
           [played](auto& o) { return played(o, o.plan.hold, o.plan.held); });
  property(c, "loads",
           "What the parts of the robot bear in the scene's own drop, as RobotLanding.loads; of limits too.",
           [](auto& o) { return o.plan.found ? loads_of_landing(o.scene, o.plan.landing) : py::dict(); });
  property(c, "share",
           "The share of fresh drops in which the motions keep every limit [1]; None: no fresh drops were played.",
           [](auto& o) { return tools::kept_share(o.plan); });
  c.def("__repr__", [](const BodyOptimum& o) {
    if (!o.plan.found) return "<ukemi.RobotOptimum: " + o.plan.message + ">";
    return fmt::format("<ukemi.RobotOptimum: {}; {}>", tools::motion_words(o.scene.robot, o.plan.motion),
                       minimised(o.goal(), o.plan.value));
  });
  bind_value(c);
  bind_report(
      c, tools::kOptimizeOutputs, [](auto& o) { return o.options.seed; },
      [](auto& o, tools::Run& run) { return report(o.scene, o.plan, o.options, o.options.rate, {}, run); });
}

BodyOptimum planned(const BodyScene& scene, BodyPlanOptions options) {
  options.validate();
  return long_call([&](const std::function<bool()>& stop) {
    options.monitor.stop = stop;
    BodyOptimum out{scene, plan(scene, options), options};
    out.options.monitor = {};
    return out;
  });
}

void bind_body_optimize(py::module_& m) {
  m.def(
      "optimize",
      [](const BodyScene& scene, std::uint64_t seed, const std::string& objective, std::optional<long> evaluations,
         std::optional<double> deadline, const std::optional<std::string>& robust,
         const std::optional<std::string>& scatter, double inflate, long samples, double rate, int threads,
         const std::vector<std::string>& forbidden, bool ratings, std::optional<double> share,
         const std::optional<Path>& drops) {
        const BodyScene limited = with_limits(scene, forbidden, ratings);
        BodyPlanOptions options =
            plan_options(limited, seed, objective, evaluations, robust, scatter, inflate, samples, threads);
        options.measured = measured_drops(drops, limited, scatter, inflate);
        options.deadline = deadline, options.rate = checked_rate(rate), options.share = share;
        return planned(limited, options);
      },
      py::arg("scene"), py::arg("seed") = 1, py::arg("objective") = "peak", py::arg("evaluations") = py::none(),
      py::arg("deadline") = py::none(), py::arg("robust") = py::none(), py::arg("scatter") = py::none(),
      py::arg("inflate") = 1.0, py::arg("samples") = BodyPlanOptions().samples, py::arg("rate") = 1000.0,
      py::arg("threads") = 0, py::arg("forbid") = std::vector<std::string>{}, py::arg("respect_ratings") = false,
      py::arg("share") = py::none(), py::arg("drops") = py::none(),
      "The same of a robot of links: a motion for every driven joint. forbid: contacts that must never touch. Stops of "
      "the scene are kept, with robust in `share` of the drops [1]. drops: a CSV file of measured ones, in place of "
      "drawn ones.");
}

/// A planner that throws if a second thread uses it meanwhile.
class PythonBodyPlanner {
 public:
  PythonBodyPlanner(const BodyScene& scene, const BodyPlanOptions& options)
      : scene_(scene), options_(options), planner_(scene, options) {}

  template <class State>
  BodyAnswer plan(const State& state, double deadline, std::uint64_t seed) {
    return alone(mutex_, "planner", [&] { return planner_.plan(state, deadline, seed); });
  }
  BodyAnswer plan_in_air(double height, const std::map<std::string, std::pair<double, double>>& joints,
                         double forward_speed, double pitch, double pitch_rate, double elapsed,
                         const std::optional<double>& vertical_speed, double deadline, std::uint64_t seed) {
    BodyFallState s{.height = height,
                    .forward_speed = forward_speed,
                    .pitch = pitch,
                    .pitch_rate = pitch_rate,
                    .elapsed = elapsed,
                    .vertical_speed = vertical_speed};
    std::size_t named = 0;
    for (const Joint& j : scene_.robot.joints) {
      const auto at = joints.find(j.name);
      if (j.driven() && at == joints.end()) throw InputError("joints: " + j.name + ": its (angle, rate) is missing");
      named += at != joints.end();
      s.joints.push_back(at == joints.end() ? BodyRelease::Joint{j.phi, 0}
                                            : BodyRelease::Joint{at->second.first, at->second.second});
    }
    if (named != joints.size()) throw InputError("joints: a name that is no joint of this robot");
    return plan(s, deadline, seed);
  }
  const BodyScene& scene() const { return scene_; }
  const std::string goal() const { return tools::goal_words(options_.goal, options_.measure); }

 private:
  const BodyScene scene_;
  const BodyPlanOptions options_;
  BodyPlanner planner_;
  std::mutex mutex_;
};

/// An answer as a dict.
py::dict dict_of(const PythonBodyPlanner& p, const BodyAnswer& a) {
  py::dict out;
  out["status"] = name(a.status), out["found"] = a.found(), out["wrong"] = a.wrong;
  out["motions"] = a.found() ? py::object(by_joint(p.scene().robot, a.plan.motion)) : py::none();
  out["goal"] = p.goal(), out["value"] = a.found() ? py::cast(a.plan.value) : py::none();
  out["held_value"] = a.found() ? py::cast(a.plan.held_value) : py::none();
  out["loads"] = a.found() ? py::object(loads_of_landing(p.scene(), a.plan.landing)) : py::none();
  return out;
}

void bind_body_planner(py::module_& m) {
  py::class_<PythonBodyPlanner>(m, "RobotPlanner", "The planner of a control program of a robot of links.")
      .def(py::init([](const BodyScene& scene, const std::string& objective, const std::vector<std::string>& forbidden,
                       bool ratings, int threads) {
             return std::make_unique<PythonBodyPlanner>(
                 with_limits(scene, forbidden, ratings),
                 BodyPlanOptions{.goal = goal_of(objective), .threads = threads});
           }),
           py::arg("scene"), py::arg("objective") = "tolerant", py::arg("forbid") = std::vector<std::string>{},
           py::arg("respect_ratings") = false, py::arg("threads") = 0)
      .def(
          "plan",
          [](PythonBodyPlanner& p, double height, double forward_speed, double pitch, double pitch_rate,
             double deadline, std::uint64_t seed) {
            return dict_of(p, p.plan(Drop{height, forward_speed, pitch, pitch_rate}, deadline, seed));
          },
          py::arg("height"), py::arg("forward_speed") = 0.0, py::arg("pitch") = 0.0, py::arg("pitch_rate") = 0.0,
          py::arg("deadline") = 0.1, py::arg("seed") = 1,
          "The best motions for a drop from rest by the deadline [s]: a dict of status, found, wrong, motions (by "
          "joint), goal, value and held_value [m/s^2], loads as RobotLanding.loads. height [m], forward_speed [m/s], "
          "pitch [rad], pitch_rate [rad/s].")
      .def(
          "plan_in_air",
          [](PythonBodyPlanner& p, double height, const std::map<std::string, std::pair<double, double>>& joints,
             double forward_speed, double pitch, double pitch_rate, double elapsed,
             std::optional<double> vertical_speed, double deadline, std::uint64_t seed) {
            return dict_of(p, p.plan_in_air(height, joints, forward_speed, pitch, pitch_rate, elapsed, vertical_speed,
                                            deadline, seed));
          },
          py::arg("height"), py::arg("joints"), py::arg("forward_speed") = 0.0, py::arg("pitch") = 0.0,
          py::arg("pitch_rate") = 0.0, py::arg("elapsed") = 0.0, py::arg("vertical_speed") = py::none(),
          py::arg("deadline") = 0.05, py::arg("seed") = 1,
          "The same for a robot that falls already: joints is a dict of (angle [rad], rate [rad/s]) of each driven "
          "joint, elapsed: the time since release [s], vertical_speed upwards [m/s].");
}

/// The loads by name, each with the number and the share of drops in which it exceeds its rating.
py::dict loads_of_risk(const BodyRiskResult& r) {
  py::dict out = loads_of_scene(r.scene);
  for (const RiskEvent& e : r.risk.events) {
    if (e.load < 0) continue;
    py::object load = out[r.scene.loads[std::size_t(e.load)].name.c_str()];
    load["drops"] = e.drops, load["share"] = double(e.drops) / double(r.risk.peaks.samples);
  }
  return out;
}
/// Share of drops in which each forbidden contact touches, by name.
std::map<std::string, double> touches_of(const BodyRiskResult& r) {
  std::map<std::string, double> out;
  for (const RiskEvent& e : r.risk.events)
    if (e.kind == RiskEvent::Kind::kTouch)
      out[r.scene.robot.contacts[std::size_t(e.point)].name] = double(e.drops) / double(r.risk.peaks.samples);
  return out;
}

void bind_body_risk(py::module_& m) {
  py::class_<BodyRiskResult> c(m, "RobotRisk", "The peaks of a robot of links over drops that scatter.");
  bind_peak_risk(
      c, [](auto& r) -> auto& { return r.risk; });
  property(c, "loads",
           "The loads and limits as RobotScene.loads, each with the drops in which it is beyond its rating and their "
           "share [1].",
           loads_of_risk);
  property(c, "touches", "Of the contacts that must not touch, by name: the share of drops in which one does [1].",
           touches_of);
  c.def("__repr__", [](const BodyRiskResult& r) {
    return "<ukemi.RobotRisk: " + tools::distribution_words(r.risk.peaks) + " m/s^2>";
  });
  bind_value(c);
  bind_report(
      c, tools::kRiskOutputs, [](auto& r) { return r.options.seed; },
      [](auto& r, tools::Run& run) { return report(r.scene, r.motion, r.risk, r.options, run); });
  m.def(
      "risk",
      [](const BodyScene& scene, const JointMotions& motions, const std::optional<std::string>& scatter, double inflate,
         bool inexact, long samples, std::uint64_t seed, int threads, const std::vector<std::string>& forbidden,
         const std::optional<Path>& drops) {
        BodyRiskOptions options{.samples = samples, .scatter = parsed_scatter(scatter)};
        if (drops && inexact) throw InputError("inexact: beside drops it has no effect");
        options.drops = {.inflate = inflation(inflate), .inexact = inexact};
        options.seed = seed, options.threads = threads;
        options.validate();
        const BodyScene limited = with_limits(scene, forbidden, false);
        options.measured = measured_drops(drops, limited, scatter, inflate);
        const BodyMotion motion = motions_of(scene, motions);
        return long_call([&](const std::function<bool()>& stop) {
          options.monitor.stop = stop;
          BodyRiskResult out{limited, motion, body_risk(limited, motion, options), options};
          out.options.monitor = {};
          return out;
        });
      },
      py::arg("scene"), py::arg("motions"), py::arg("scatter") = py::none(), py::arg("inflate") = 1.0,
      py::arg("inexact") = false, py::arg("samples") = BodyRiskOptions().samples, py::arg("seed") = 1,
      py::arg("threads") = 0, py::arg("forbid") = std::vector<std::string>{}, py::arg("drops") = py::none(),
      "The same of a robot of links. motions: of its joints by name; one that is not named is held as its scene says.");
}

}  // namespace

BodyScene with_limits(BodyScene scene, const std::vector<std::string>& forbidden, bool ratings) {
  forbid(scene, forbidden);
  if (ratings) (void)respect_ratings(scene);
  return scene;
}
BodyPlanOptions plan_options(const BodyScene& scene, std::uint64_t seed, const std::string& objective,
                             std::optional<long> evaluations, const std::optional<std::string>& robust,
                             const std::optional<std::string>& scatter, double inflate, long samples, int threads) {
  BodyPlanOptions out;
  out.goal = goal_of(objective), out.evaluations = evaluations;
  if (robust) out.measure = Measure::parse("robust", *robust);
  out.scatter = parsed_scatter(scatter), out.inflate = inflation(inflate), out.samples = samples;
  out.seed = seed, out.threads = threads;
  out.validate();
  if (out.scatter) (void)BodyDropModel(scene, *out.scatter);  // throws for what this base lacks
  return out;
}

void bind_body_plan(py::module_& m) {
  bind_body_optimum(m), bind_body_optimize(m), bind_body_planner(m), bind_body_risk(m);
}

}  // namespace ukemi::python

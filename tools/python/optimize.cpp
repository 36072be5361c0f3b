// Python bindings of the search for the best motion.
#include <fmt/format.h>

#include "landing/judge/answer.hpp"
#include "tools/python/arguments.hpp"
#include "tools/report/body.hpp"
#include "tools/report/exports.hpp"
#include "tools/report/results.hpp"
#include "tools/report/scatter.hpp"

namespace ukemi::python {

using namespace landing;

RobustOptions robust_of(const Arguments& a) {
  RobustOptions out{.scatter = parsed_scatter(a.scatter), .inflate = inflation(a.inflate)};
  if (a.robust) out.measure = Measure::parse("robust", *a.robust);
  out.samples = long(checked("samples", double(a.samples), {16, 4096, false, "16 to 4096"}));
  return out;
}

BodyScene with_limits(BodyScene scene, const Arguments& a) {
  forbid(scene, a.forbid);
  if (a.respect_ratings) (void)respect_ratings(scene);
  return scene;
}
BodyPlanOptions plan_options(const BodyScene& scene, const Arguments& a) {
  BodyPlanOptions out;
  out.goal = goal_of(a.objective), out.evaluations = a.evaluations;
  if (a.robust) out.measure = Measure::parse("robust", *a.robust);
  out.scatter = parsed_scatter(a.scatter), out.inflate = inflation(a.inflate), out.samples = a.samples;
  out.seed = a.seed, out.threads = a.threads;
  out.validate();
  if (out.scatter) (void)BodyDropModel(scene, *out.scatter);  // throws for what this base lacks
  return out;
}

namespace {

/// Variables on an edge of their range, by name: "lower", "upper".
std::map<std::string, std::string> edges_of(const std::vector<Variable>& variables, const Edges& edges) {
  std::map<std::string, std::string> out;
  for (std::size_t k = 0; k < variables.size(); ++k)
    if (edges[k] != 0) out[variables[k].name] = edges[k] < 0 ? "lower" : "upper";
  return out;
}

AnswerOptions options_of(const Arguments& a, const Actuator& actuator) {
  require_gains(actuator);
  AnswerOptions out;
  OptimizeOptions& o = out.search;
  o.solver = a.solver, o.goal = goal_of(a.objective), o.evaluations = a.evaluations, o.deadline = a.deadline;
  o.limits.forbidden = points_of(a.forbid);
  o.seed = a.seed, o.threads = a.threads;
  if (a.respect_ratings) respect_ratings(actuator, o);
  o.validate();
  out.rate = checked_rate(a.rate);
  out.robust = robust_of(a);
  return out;
}

Answer optimized(const Arguments& a, const Scene& scene, const Actuator& actuator) {
  AnswerOptions options = options_of(a, actuator);
  options.robust.drops = measured_drops(a, scene, actuator);
  Answer out =
      monitored([&] { return answer(scene, actuator, options); }, options.search.monitor, options.evidence_monitor);
  out.options.search.monitor = out.options.evidence_monitor = {};
  return out;
}

/// A landing of the answer, as `simulate` returns it but without a check of its sensitivity.
Played played(const Answer& a, const Motion& motion, const Landing& landing) {
  Played out{.checked = {.scene = a.scene, .motion = motion, .accuracy = a.options.search.accuracy},
             .actuator = a.actuator};
  out.checked.landing = landing, out.rate = a.options.rate;
  out.checked.ratings = ratings(a.scene, a.actuator, motion, landing);
  out.checked.instability = instability(a.scene, a.actuator.sea, motion);
  return out;
}

void bind_answer(py::module_& m) {
  Value<Answer> c(m, "Optimum", "The best motion that was found, its landing beside that of the held reference.");
  property(c, "found", "Whether any motion could be followed within the limits.", [](auto& a) { return a.best.found; });
  property(c, "message", "Why nothing was found, or why the search ended before all was spent.",
           [](auto& a) { return a.best.message; });
  property(c, "motion", "The best motion, with what it minimised.", [](auto& a) {
    return PlannedMotion{a.best.motion, tools::goal_words(a.options), a.best.value};
  });
  property(c, "goal", "What was minimised.", [](auto& a) { return tools::goal_words(a.options); });
  property(c, "peak", "Its largest |ddr_0| [m/s^2].", &Answer::peak);
  property(c, "tolerant_peak",
           "The worst peak within the scene's execution tolerance [m/s^2], or None where it was not played.",
           [](auto& a) { return a.tolerant_known ? std::optional(a.best.tolerant.value) : std::nullopt; });
  property(c, "edges", "Variables that lie on an edge of their search range, by name: \"lower\" or \"upper\".",
           [](auto& a) {
             const ReferenceSpace space(a.scene, a.best.sea);
             return edges_of(space.variables(), a.best.edges);
           });
  property(c, "held_deg", "The best posture to hold that the search found [deg], or None.",
           [](auto& a) { return a.best.held ? std::optional(a.best.held->motion.phi_i * kDegrees) : std::nullopt; });
  property(c, "held_peak", "Of the reference held there [m/s^2].", &Answer::held_peak);
  property(c, "reduction", "1 - peak / held_peak [1].", &Answer::reduction);
  property(c, "value", "Of the goal: the peak, the tolerant peak, or the measure under scatter [m/s^2].",
           [](auto& a) { return a.best.value; });
  property(c, "evaluations", "Motions that were searched.", [](auto& a) { return a.best.evaluations; });
  property(c, "seconds", "That the search took [s].", [](auto& a) { return a.best.seconds; });
  property(c, "solver", "That found it.", [](auto& a) { return a.best.solver; });
  c.def("__repr__", [](const Answer& a) {
    if (!a.best.found) return "<ukemi.Optimum: " + a.best.message + ">";
    return fmt::format("<ukemi.Optimum: {}; {}>", tools::motion_words(a.best.motion),
                       minimised(tools::goal_words(a.options), a.best.value));
  });
  bind_figure(
      c,
      [](const Answer& a) {
        return figure({{"best motion", &a.landing}, {"held", &a.held}});
      },
      "|ddr_0| [m/s^2] over time [s] of the motion and of the held reference.");
  property(c, "landing", "The landing of the motion.", [](auto& a) { return played(a, a.best.motion, a.landing); });
  property(c, "held", "The landing of the held reference, or None where none is known.",
           [](auto& a) { return a.best.held ? std::optional(played(a, a.best.held->motion, a.held)) : std::nullopt; });
  bind_report(
      c, tools::kOptimizeOutputs, [](auto& a) { return a.options.search.seed; },
      [](auto& a, tools::Run& run) { return report(a, a.options.rate, {}, run); });
}

void bind_paper_optimize(py::module_& m) {
  define(
      m, "optimize", &optimized, py::arg("scene"), py::arg("actuator"), kSeed, kObjective, kSolver, kEvaluations,
      kDeadline, kForbid, kRespectRatings, kRobust, kScatter, kInflate, kSamples.with(RobustOptions().samples), kRate,
      kThreads, kDrops,
      "The knee motion with the smallest peak acceleration of the thigh (Eq. 6), as `ukemi optimize`. objective: peak "
      "or tolerant; deadline [s] from the call; forbid: of hip, knee, foot; robust: mean, cvar, quantile:Q or worst, "
      "over drops that scatter as the text scatter says (\"pitch_deg=1,height=0.01\"); rate: rows of the trajectories "
      "a second [Hz].");
}

struct BodyOptimum {
  BodyScene scene;
  BodyPlan plan;
  BodyPlanOptions options;

  std::string goal() const { return tools::goal_words(options.goal, options.measure); }
};
void bind_body_optimum(py::module_& m) {
  Value<BodyOptimum> c(m, "RobotOptimum", "The best motions of a robot of links beside the held posture.");
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
  bind_report(
      c, tools::kOptimizeOutputs, [](auto& o) { return o.options.seed; },
      [](auto& o, tools::Run& run) { return report(o.scene, o.plan, o.options, o.options.rate, {}, run); });
}

void bind_body_optimize(py::module_& m) {
  define(
      m, "optimize",
      [](const Arguments& a, const BodyScene& scene) {
        const BodyScene limited = with_limits(scene, a);
        BodyPlanOptions options = plan_options(limited, a);
        options.measured = measured_drops(a, limited);
        options.deadline = a.deadline, options.rate = checked_rate(a.rate), options.share = a.share;
        options.solver = a.solver;
        options.validate();
        const BodyPlan found = monitored([&] { return plan(limited, options); }, options.monitor);
        return BodyOptimum{limited, found, options};
      },
      py::arg("scene"), kSeed, kObjective, kEvaluations, kDeadline, kRobust, kScatter, kInflate, kSamples, kRate,
      kThreads, kForbid, kRespectRatings, kShare, kDrops, kSolver,
      "The same of a robot of links: a motion for every driven joint. forbid: contacts that must never touch. Stops of "
      "the scene are kept, with robust in `share` of the drops [1]. drops: a CSV file of measured ones, in place of "
      "drawn ones.");
}

}  // namespace

void bind_optimize(py::module_& m) {
  bind_answer(m), bind_body_optimum(m), bind_paper_optimize(m), bind_body_optimize(m);
}

}  // namespace ukemi::python

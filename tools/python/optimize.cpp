// Python bindings of the search for the best motion.
#include <fmt/format.h>

#include "landing/judge/answer.hpp"
#include "tools/python/search.hpp"
#include "tools/report/exports.hpp"
#include "tools/report/results.hpp"
#include "tools/report/scatter.hpp"

namespace ukemi::python {

using namespace landing;

std::map<std::string, std::string> edges_of(const std::vector<Variable>& variables, const Edges& edges) {
  std::map<std::string, std::string> out;
  for (std::size_t k = 0; k < variables.size(); ++k)
    if (edges[k] != 0) out[variables[k].name] = edges[k] < 0 ? "lower" : "upper";
  return out;
}

RobustOptions robust_of(const std::optional<std::string>& measure, const std::optional<std::string>& scatter,
                        double inflate, long samples) {
  RobustOptions out{.scatter = parsed_scatter(scatter), .inflate = inflation(inflate)};
  if (measure) out.measure = Measure::parse("robust", *measure);
  out.samples = checked_samples(samples);
  return out;
}

namespace {

struct OptimizeArguments {
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
  std::optional<Path> drops;
};
AnswerOptions options_of(const OptimizeArguments& a, const Actuator& actuator) {
  require_gains(actuator);
  AnswerOptions out;
  OptimizeOptions& o = out.search;
  o.solver = a.solver, o.goal = goal_of(a.objective), o.evaluations = a.evaluations, o.deadline = a.deadline;
  o.limits.forbidden = points_of(a.forbid);
  o.seed = a.seed, o.threads = a.threads;
  if (a.respect_ratings) respect_ratings(actuator, o);
  o.validate();
  out.rate = checked_rate(a.rate);
  out.robust = robust_of(a.robust, a.scatter, a.inflate, a.samples);
  return out;
}

Answer optimized(const Scene& scene, const Actuator& actuator, const OptimizeArguments& arguments) {
  AnswerOptions options = options_of(arguments, actuator);
  options.robust.drops = measured_drops(arguments.drops, scene, actuator, arguments.scatter, arguments.inflate);
  return long_call([&](const std::function<bool()>& stop) {
    options.search.monitor.stop = options.evidence_monitor.stop = stop;
    Answer out = answer(scene, actuator, options);
    out.options.search.monitor = out.options.evidence_monitor = {};
    return out;
  });
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

void bind_landings(py::class_<Answer>& c) {
  property(c, "landing", "The landing of the motion.", [](auto& a) { return played(a, a.best.motion, a.landing); });
  property(c, "held", "The landing of the held reference, or None where none is known.",
           [](auto& a) { return a.best.held ? std::optional(played(a, a.best.held->motion, a.held)) : std::nullopt; });
}

/// Binds the values of the motion and of the held posture.
void bind_values(py::class_<Answer>& c) {
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
}
void bind_search(py::class_<Answer>& c) {
  property(c, "evaluations", "Motions that were searched.", [](auto& a) { return a.best.evaluations; });
  property(c, "seconds", "That the search took [s].", [](auto& a) { return a.best.seconds; });
  property(c, "solver", "That found it.", [](auto& a) { return a.best.solver; });
}

void bind_answer(py::module_& m) {
  py::class_<Answer> c(m, "Optimum", "The best motion that was found, its landing beside that of the held reference.");
  property(c, "found", "Whether any motion could be followed within the limits.", [](auto& a) { return a.best.found; });
  property(c, "message", "Why nothing was found, or why the search ended before all was spent.",
           [](auto& a) { return a.best.message; });
  property(c, "motion", "The best motion, with what it minimised.", [](auto& a) {
    return PlannedMotion{a.best.motion, tools::goal_words(a.options), a.best.value};
  });
  property(c, "goal", "What was minimised.", [](auto& a) { return tools::goal_words(a.options); });
  bind_values(c), bind_search(c);
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
  bind_landings(c);
  bind_value(c);
  bind_report(
      c, tools::kOptimizeOutputs, [](auto& a) { return a.options.search.seed; },
      [](auto& a, tools::Run& run) { return report(a, a.options.rate, {}, run); });
}

}  // namespace

void bind_optimize(py::module_& m) {
  bind_answer(m);
  m.def(
      "optimize",
      [](const Scene& scene, const Actuator& actuator, std::uint64_t seed, const std::string& objective,
         const std::string& solver, std::optional<long> evaluations, std::optional<double> deadline,
         const std::vector<std::string>& forbid, bool respect_ratings, const std::optional<std::string>& robust,
         const std::optional<std::string>& scatter, double inflate, long samples, double rate, int threads,
         const std::optional<Path>& drops) {
        return optimized(scene, actuator,
                         {objective, solver, evaluations, deadline, forbid, respect_ratings, robust, scatter, inflate,
                          samples, rate, seed, threads, drops});
      },
      py::arg("scene"), py::arg("actuator"), py::arg("seed") = 1, py::arg("objective") = "peak",
      py::arg("solver") = "auto", py::arg("evaluations") = py::none(), py::arg("deadline") = py::none(),
      py::arg("forbid") = std::vector<std::string>{}, py::arg("respect_ratings") = false,
      py::arg("robust") = py::none(), py::arg("scatter") = py::none(), py::arg("inflate") = 1.0,
      py::arg("samples") = RobustOptions().samples, py::arg("rate") = 1000.0, py::arg("threads") = 0,
      py::arg("drops") = py::none(),
      "The knee motion with the smallest peak acceleration of the thigh (Eq. 6), as `ukemi optimize`. objective: peak "
      "or tolerant; deadline [s] from the call; forbid: of hip, knee, foot; robust: mean, cvar, quantile:Q or worst, "
      "over drops that scatter as the text scatter says (\"pitch_deg=1,height=0.01\"); rate: rows of the trajectories "
      "a second [Hz].");
}

}  // namespace ukemi::python

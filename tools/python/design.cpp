// Python bindings of the design of hits.
#include <fmt/format.h>

#include "tools/program/arguments.hpp"
#include "tools/python/arguments.hpp"
#include "tools/report/design.hpp"
#include "tools/study/robot_design.hpp"

namespace ukemi::python {

using namespace identify;

namespace {

struct DesignResult {
  tools::DesignQuestion question;
  tools::DesignAnswer answer;
};

/// Relative 95 % half-widths by the constant's name.
std::map<std::string, double> widths(const DesignResult& r, const Eigen::VectorXd& of) {
  std::map<std::string, double> out;
  for (Eigen::Index i = 0; i < of.size(); ++i)
    out[kConstantNames[std::size_t(r.question.knowledge.constants[std::size_t(i)])]] = of[i];
  return out;
}

void bind_hit(py::module_& m) {
  Value<ProposedHit> c(m, "Hit", "A half-sine hit that is proposed.");
  property(c, "peak", "Its largest force [N]; below 0: the other way.", [](auto& h) { return h.hit.peak; });
  property(c, "width", "How long it lasts [s].", [](auto& h) { return h.hit.width; });
  property(c, "angle", "Largest |phi_1| at the estimate [rad].", [](auto& h) { return h.safety.angle; });
  property(c, "worst_angle", "The same within the constants' uncertainty [rad].",
           [](auto& h) { return h.safety.worst_angle; });
  property(c, "torque", "Largest torque of the spring before its limit [Nm].", [](auto& h) { return h.safety.torque; });
  c.repr([](auto& h) { return fmt::format(" {:.4g} N for {:.4g} s", h.hit.peak, h.hit.width); });
}

void bind_design_class(py::module_& m) {
  Value<DesignResult> c(m, "Design", "Hits that shrink the constants' error bars most.");
  property(c, "found", "Whether there are safe hits that determine the constants.",
           [](auto& r) { return r.answer.design.status == Design::Status::kDone; });
  property(c, "message", "Why there are none.", [](auto& r) { return r.answer.design.message; });
  property(c, "hits", "The proposed hits, each a trial.", [](auto& r) { return r.answer.design.hits; });
  property(c, "before", "Half of each constant's 95 % interval over its value, in hand [1].",
           [](auto& r) { return widths(r, r.answer.design.before); });
  property(c, "after", "The same with the hits, predicted [1].",
           [](auto& r) { return widths(r, r.answer.design.after); });
  property(c, "criterion", "What was minimised: worst, d or e.",
           [](auto& r) { return name(r.question.options.criterion); });
  property(c, "value", "Of the criterion, with the hits [1].", [](auto& r) { return r.answer.design.size_after; });
  property(c, "agrees", "Whether simulated experiments scatter as predicted, or None where none were made.",
           [](auto& r) { return r.answer.check ? std::optional(r.answer.check->agrees) : std::nullopt; });
  c.def("__repr__", [](const DesignResult& r) {
    const Design& d = r.answer.design;
    if (d.status != Design::Status::kDone) return "<ukemi.Design: " + d.message + ">";
    return fmt::format("<ukemi.Design of {} hits; criterion {} {:.4g}, before {:.4g}>", d.hits.size(),
                       name(r.question.options.criterion), d.size_after, d.size_before);
  });
  bind_report(
      c, tools::kDesignOutputs, [](auto& r) { return r.question.options.seed; },
      [](auto& r, tools::Run& run) {
        for (const std::string& doubt : design_doubts(r.question)) run.warn(doubt);
        return report(r.question, r.answer, tools::Json::object(), run);
      });
}

DesignOptions options_of(double peak, const std::pair<double, double>& width, double angle, int hits,
                         const std::string& criterion, const std::string& directions) {
  using enum HitBudget::Directions;
  DesignOptions o;
  o.budget.peak = peak, o.budget.min_width = width.first, o.budget.max_width = width.second, o.budget.angle = angle;
  o.hits = hits;
  o.criterion = tools::choice("criterion", criterion, tools::criteria());
  o.budget.directions =
      tools::choice<HitBudget::Directions>("directions", directions, {{"both", kAlternate}, {"positive", kPositive}});
  return o;
}

void bind_paper_design(py::module_& m) {
  m.def(
      "design",
      [](const Rig& rig, const Actuator& actuator, const std::vector<Trial>& trials, double peak,
         const std::pair<double, double>& width, double angle, int hits, const std::string& criterion,
         const std::string& directions, double rate, double duration, std::optional<double> noise,
         std::optional<double> tau_max, int check, std::uint64_t seed, int threads) {
        checked("check", check, {0, 100'000, false, "0 to 100000"});
        tools::DesignRequest r{.rig = rig, .actuator = actuator, .trials = prepared(trials, rig, {})};
        r.trials = with_nearer_force(rig, r.trials, rig.mounted(actuator.sea));
        r.options = options_of(peak, width, angle, hits, criterion, directions);
        r.options.log.rate = rate, r.options.log.duration = duration;
        r.options.seed = seed, r.options.threads = threads;
        r.noise = checked("noise", noise, Range::positive());
        r.tau_max = checked("tau_max", tau_max, Range::non_negative());
        const py::gil_scoped_release release;
        DesignResult out{design_question(r), {}};
        out.answer = answer(out.question, check);
        return out;
      },
      py::arg("rig"), py::arg("actuator"), py::arg("trials") = std::vector<Trial>{}, py::arg("peak") = HitBudget().peak,
      py::arg("width") = std::pair(HitBudget().min_width, HitBudget().max_width), py::arg("angle") = HitBudget().angle,
      py::arg("hits") = DesignOptions().hits, py::arg("criterion") = "worst", py::arg("directions") = "both",
      py::arg("rate") = HitLog().rate, py::arg("duration") = HitLog().duration, py::arg("noise") = py::none(),
      py::arg("tau_max") = py::none(), py::arg("check") = 50, py::arg("seed") = 1, py::arg("threads") = 0,
      "The hits that shrink the constants' error bars most, as `ukemi design`. trials: in hand (none: the actuator's "
      "covariance); peak [N], width (shortest, longest) [s], angle [rad]: what a hit may be; criterion: worst, d or e; "
      "directions: both or positive; rate [Hz], duration [s] of the next logs, noise of an angle [rad]; tau_max [Nm]; "
      "check: simulated experiments that test the prediction.");
}

using tools::DrivenRobot, tools::CandidateTrial, tools::RobotDesign, tools::RobotTrial;

std::map<std::string, double> widths(const RobotDesign& d, const Eigen::VectorXd& of) {
  std::map<std::string, double> out;
  for (std::size_t i = 0; i < d.constants.size(); ++i) out[d.constants[i]] = of[long(i)];
  return out;
}

struct RobotDesignArguments : Arguments {
  std::vector<RobotTrial> trials = {};
  std::map<std::string, double> noise = {};
  int count = 2;
  std::vector<double> heights = {};
};

void bind_next_trial(py::module_& m) {
  Value<CandidateTrial> c(m, "NextTrial", "Commands that could be logged next, beside what is in hand.");
  c.def_readonly("file", &CandidateTrial::file, "Of the commands.")
      .def_readonly("followed", &CandidateTrial::followed, "Whether the robot can be simulated under them.")
      .def_readonly("rank", &CandidateTrial::rank, "1: the best to log next; 0: not chosen.")
      .def_readonly("alone", &CandidateTrial::alone, "The criterion with what is in hand and this one [1].")
      .def_readonly("together", &CandidateTrial::together, "Of a chosen one: with all those of lower rank [1].");
  c.repr([](auto& t) {
    return fmt::format(" {}, {}", t.file, t.rank > 0 ? fmt::format("rank {}", t.rank) : "not chosen");
  });
}

void bind_robot_design_class(py::module_& m) {
  Value<RobotDesign> c(m, "RobotDesign", "Commands whose logs shrink the constants' error bars most.");
  c.def_readonly("candidates", &RobotDesign::candidates, "In the order that they were given.");
  property(c, "before",
           "Half of each constant's 95 % interval over its value, or over the size that it is judged by, in hand [1].",
           [](auto& d) { return widths(d, d.before); });
  property(c, "after", "The same with the chosen ones, predicted [1].", [](auto& d) { return widths(d, d.after); });
  property(c, "criterion", "What was minimised: worst, d or e.", [](auto& d) { return name(d.criterion); });
  c.def_readonly("value", &RobotDesign::size_after, "Of the criterion, with the chosen ones [1].")
      .def("__repr__", [](const RobotDesign& d) {
        return fmt::format("<ukemi.RobotDesign of {} candidates; criterion {} {:.4g}, before {:.4g}>",
                           d.candidates.size(), name(d.criterion), d.size_after, d.size_before);
      });
  bind_report(c, tools::kDesignOutputs, kNoSeed, [](auto& d, tools::Run& run) { return report(d, run); });
}

void bind_robot_design(py::module_& m) {
  define(
      m, "design_robot",
      [](const RobotDesignArguments& a, const DrivenRobot& robot, const std::vector<RobotTrial>& candidates,
         const std::vector<std::string>& free) {
        const std::vector<RobotTrial> next = tools::from_heights(robot, candidates, a.heights);
        tools::RobotDesignOptions o{.criterion = tools::choice("criterion", a.criterion, tools::criteria()),
                                    .trials = a.count,
                                    .noise = a.noise};
        const auto terms = tools::design_terms(robot, a.trials, next, a.noise);
        o.fit.terms = chosen_terms(terms, {.nuisance = terms.nuisance, .free = free});
        o.fit.threads = a.threads;
        const py::gil_scoped_release release;
        return tools::design_trials(robot, a.trials, next, o);
      },
      py::arg("robot"), py::arg("candidates"), py::arg("free"), Argument{"trials", &RobotDesignArguments::trials},
      Argument{"noise", &RobotDesignArguments::noise}, Argument{"count", &RobotDesignArguments::count}, kCriterion,
      kThreads, Argument{"heights", &RobotDesignArguments::heights},
      "Which of some commands to log next, as `ukemi design --robot`. candidates: logs read with commands=True; free: "
      "the constants that are to be known; trials: in hand; noise: standard deviations of channels, as {\"phi\": 1e-3} "
      "[their SI units]; count: how many are chosen; criterion: worst, d or e; heights: each candidate from each of "
      "them, of the lowest contact over the floor [m].");
}

}  // namespace

void bind_design(py::module_& m) {
  bind_hit(m), bind_design_class(m), bind_paper_design(m);
  bind_next_trial(m), bind_robot_design_class(m), bind_robot_design(m);
}

}  // namespace ukemi::python

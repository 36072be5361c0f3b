// Python bindings of the design of trials of robots of links.
#include "tools/study/robot_design.hpp"

#include <fmt/format.h>

#include "tools/program/arguments.hpp"
#include "tools/python/landing.hpp"
#include "tools/report/design.hpp"

namespace ukemi::python {

namespace {

using tools::DrivenRobot, tools::CandidateTrial, tools::RobotDesign, tools::RobotTrial;

std::map<std::string, double> widths(const RobotDesign& d, const Eigen::VectorXd& of) {
  std::map<std::string, double> out;
  for (std::size_t i = 0; i < d.constants.size(); ++i) out[d.constants[i]] = of[long(i)];
  return out;
}

void bind_next_trial(py::module_& m) {
  py::class_<CandidateTrial> c(m, "NextTrial", "Commands that could be logged next, beside what is in hand.");
  c.def_readonly("file", &CandidateTrial::file, "Of the commands.")
      .def_readonly("followed", &CandidateTrial::followed, "Whether the robot can be simulated under them.")
      .def_readonly("rank", &CandidateTrial::rank, "1: the best to log next; 0: not chosen.")
      .def_readonly("alone", &CandidateTrial::alone, "The criterion with what is in hand and this one [1].")
      .def_readonly("together", &CandidateTrial::together, "Of a chosen one: with all those of lower rank [1].")
      .def("__repr__", [](const CandidateTrial& t) {
        return fmt::format("<ukemi.NextTrial {}, {}>", t.file,
                           t.rank > 0 ? fmt::format("rank {}", t.rank) : "not chosen");
      });
  bind_value(c);
}

void bind_robot_design_class(py::module_& m) {
  py::class_<RobotDesign> c(m, "RobotDesign", "Commands whose logs shrink the constants' error bars most.");
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
  bind_value(c);
  bind_report(c, tools::kDesignOutputs, kNoSeed, [](auto& d, tools::Run& run) { return report(d, run); });
}

}  // namespace

void bind_robot_design(py::module_& m) {
  bind_next_trial(m), bind_robot_design_class(m);
  m.def(
      "design_robot",
      [](const DrivenRobot& robot, const std::vector<RobotTrial>& candidates, const std::vector<std::string>& free,
         const std::vector<RobotTrial>& trials, const std::map<std::string, double>& noise, int count,
         const std::string& criterion, int threads, const std::vector<double>& heights) {
        const std::vector<RobotTrial> next = tools::from_heights(robot, candidates, heights);
        tools::RobotDesignOptions o{
            .criterion = tools::choice("criterion", criterion, tools::criteria()), .trials = count, .noise = noise};
        o.fit.terms = tools::design_terms(robot, trials, next, noise);
        const std::vector<std::string> starts = o.fit.terms.nuisance;
        o.fit.terms = chosen_terms(std::move(o.fit.terms), free, starts, {}, {}, {});
        o.fit.threads = threads;
        const py::gil_scoped_release release;
        return tools::design_trials(robot, trials, next, o);
      },
      py::arg("robot"), py::arg("candidates"), py::arg("free"), py::arg("trials") = std::vector<RobotTrial>{},
      py::arg("noise") = std::map<std::string, double>{}, py::arg("count") = 2, py::arg("criterion") = "worst",
      py::arg("threads") = 0, py::arg("heights") = std::vector<double>{},
      "Which of some commands to log next, as `ukemi design --robot`. candidates: logs read with commands=True; free: "
      "the constants that are to be known; trials: in hand; noise: standard deviations of channels, as {\"phi\": 1e-3} "
      "[their SI units]; count: how many are chosen; criterion: worst, d or e; heights: each candidate from each of "
      "them, of the lowest contact over the floor [m].");
}

}  // namespace ukemi::python

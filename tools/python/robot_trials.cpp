// Python bindings of trials of robots of links.
#include "tools/study/robot_trials.hpp"

#include <fmt/format.h>

#include <variant>

#include "landing/plan/design_numbers.hpp"
#include "tools/python/arguments.hpp"
#include "tools/study/baselines.hpp"

namespace ukemi::python {

using namespace landing;

namespace {

using tools::DrivenRobot, tools::DropResult, tools::RobotFit, tools::RobotFitOptions, tools::RobotLogOptions,
    tools::RobotTrial;

/// A fit or a prediction with its trials.
struct RobotIdentified {
  RobotFit fit;
  std::vector<RobotTrial> trials;
};

/// How logs are cut: None (not at all), every so many seconds, at times, or "auto".
using Pieces = std::optional<std::variant<double, std::vector<double>, std::string>>;
RobotLogOptions log_options(const std::string& columns, const Pieces& pieces, bool multi_turn, bool commands, int tie) {
  RobotLogOptions out{.columns = columns, .pieces = 0, .times = {}};
  out.tied = checked("tie", tie, {1, 100'000, false, "1 to 100000"});
  if (commands) out.measured = RobotLogOptions::Measured::kNothing;
  if (multi_turn) out.angles = RobotLogOptions::Angles::kMultiTurn;
  if (!pieces) return out;
  if (const double* seconds = std::get_if<double>(&*pieces))
    out.pieces = checked("pieces", *seconds, Range::positive());
  else if (const auto* times = std::get_if<std::vector<double>>(&*pieces))
    require_times("pieces", out.times = *times);
  else if (std::get<std::string>(*pieces) == "auto")
    out.cuts = RobotLogOptions::Cuts::kHops;
  else
    throw InputError("pieces: " + quoted(std::get<std::string>(*pieces)) + ": seconds, times or \"auto\" is needed");
  return out;
}

void bind_robot(py::module_& m) {
  Value<DrivenRobot> c(m, "DrivenRobot", "A robot that logs drive, and what their commands pass through.");
  c.def(
      "number", [](const DrivenRobot& r, const std::string& name) { return tools::number_of(r, name); },
      py::arg("name"), "A constant by its way in the files, as \"drive.hip.i_motor\" or \"command.delay\".");
  property(c, "scene", "The robot, as `simulate` takes it.", [](auto& r) { return r.scene; });
  c.repr([](auto& r) { return fmt::format(" {} of {} links", r.scene.name, r.scene.robot.links.size()); });
  bind_reader(m, "read_driven_robot", "Reads a robot, or a scene that has one, with its [command].",
              [](const Path& path) { return tools::read_driven_robot(path); });
}

void bind_trials_of(py::module_& m) {
  Value<RobotTrial> c(m, "RobotTrial", "What was measured of a driven robot, and the commands of its log.");
  property(c, "name", "Its file, and what part of it.", [](auto& t) { return t.log.file; });
  c.def_readonly("origin", &RobotTrial::origin, "What the log's clock read at its first row [s].");
  column_property(
      c, "t", "Times from its first row [s].", [](auto& t) -> auto& { return t.log.t; });
  m.def(
      "read_robot_trials",
      [](const Path& path, const DrivenRobot& robot, const std::string& columns, const Pieces& pieces, bool multi_turn,
         bool commands, int tie) {
        return tools::read_robot_trials(path, robot.scene.robot,
                                        log_options(columns, pieces, multi_turn, commands, tie));
      },
      py::arg("path"), py::arg("robot"), py::arg("columns") = "", py::arg("pieces") = py::none(),
      py::arg("multi_turn") = false, py::arg("commands") = false, py::arg("tie") = 1,
      "Reads a log (CSV) as `ukemi identify --robot`. pieces: seconds, times of the log's clock [s], or \"auto\": "
      "where a robot on a rail pushes off; None: the whole log is one trial. commands: angles need not be there, for "
      "`design_robot`; tie: so many pieces that follow each other are one trial.");
}

py::dict by_output(const RobotIdentified& r, const std::vector<std::vector<double>>& values) {
  py::dict out;
  for (std::size_t o = 0; o < values.size(); ++o)
    if (!values[o].empty()) out[r.fit.channels[o].name.c_str()] = py::array_t<double>(py::cast(values[o]));
  return out;
}
const DropResult& result_of(const RobotIdentified& r, std::size_t trial) {
  if (trial >= r.trials.size()) throw py::index_error("no such trial");
  return r.fit.drops[trial];
}
py::dict outputs_of(const RobotIdentified& r, std::size_t trial) { return by_output(r, result_of(r, trial).value); }
py::dict bands_of(const RobotIdentified& r, std::size_t trial) {
  (void)result_of(r, trial);
  return r.fit.bands.empty() ? py::dict() : by_output(r, r.fit.bands[trial].band);
}

void bind_result(py::module_& m) {
  Value<RobotIdentified> c(m, "RobotIdentification",
                           "Constants of a robot of links fitted to trials, or trials predicted with them.");
  bind_estimates(
      c, [](auto& r) -> auto& { return r.fit; });
  bind_profiles(c, [](auto& r) { return r.fit.profiles; });
  property(c, "robot", "The given robot with the fitted constants.", [](auto& r) { return r.fit.robot; });
  property(c, "model_rejected", "Whether the residuals speak against the robot.",
           [](auto& r) { return r.fit.tests.model_rejected(); });
  property(c, "rms", "Residual of each output that was measured, by its name [its SI unit].",
           [](auto& r) { return rms_by_output(r.fit); });
  property(c, "baselines",
           "Residuals on the same samples of the robot, of each trial's first value held, and of the mean of the other "
           "trials (NaN: fewer than three) [its SI unit].",
           [](auto& r) {
             std::map<std::string, std::map<std::string, double>> out;
             const auto all = tools::baselines(r.fit, tools::logs_of(r.trials));
             for (std::size_t o = 0; o < all.size(); ++o)
               if (all[o].known())
                 out[r.fit.channels[o].name] = {{"model", all[o].model}, {"held", all[o].held}, {"mean", all[o].mean}};
             return out;
           });
  c.def("outputs", outputs_of, py::arg("trial"), "Simulated outputs of a trial, by name.")
      .def("bands", bands_of, py::arg("trial"),
           "Of a prediction, by name: half of the 95 % band about each of `outputs`, of the errors of the robot's "
           "constants and of what the fit left [its SI unit]; empty where it is not known how well they are known.")
      .def(
          "contacts",
          [](const RobotIdentified& r, std::size_t trial) {
            std::vector<std::tuple<double, std::string, bool>> out;
            for (const ContactChange& change : result_of(r, trial).changes)
              out.emplace_back(change.t, r.fit.robot.scene.robot.contacts[std::size_t(change.contact)].name,
                               change.touches);
            return out;
          },
          py::arg("trial"), "(t from the trial's first row [s], contact, whether it touches or leaves), in order.");
  c.repr([](auto& r) { return fmt::format(" of {} trials{}", r.trials.size(), r.fit.trusted() ? ", trusted" : ""); });
}

/// Python function f(t, phi, dphi) -> torques, or None.
using PyController = std::optional<py::function>;

/// The trials with a Python controller in the loop.
std::vector<RobotTrial> controlled(std::vector<RobotTrial> trials, const PyController& controller) {
  if (!controller) return trials;
  const Controller in_loop = [f = *controller](double t, std::span<const double> phi, std::span<const double> dphi,
                                               std::span<double> torque) {
    const py::gil_scoped_acquire lock;
    const auto array = [](std::span<const double> x) { return py::array_t<double>(py::ssize_t(x.size()), x.data()); };
    const auto torques = f(t, array(phi), array(dphi)).cast<std::vector<double>>();
    if (torques.size() != torque.size())
      throw InputError(
          fmt::format("controller: {} torques: {} are needed, one of each joint", torques.size(), torque.size()));
    std::copy(torques.begin(), torques.end(), torque.begin());
  };
  for (RobotTrial& t : trials) {
    auto commands = std::make_shared<Commands>(*t.commands);
    commands->controller = in_loop;
    t.commands = std::move(commands);
  }
  return trials;
}

/// The term's name for its alias; any other name unchanged.
std::string term_name(const identify::Terms<tools::DropTerm>& terms, const std::string& given) {
  for (const tools::DropTerm& t : *terms.table)
    if (t.is_called(given)) return t.name;
  return given;
}
std::vector<std::string> term_names(const identify::Terms<tools::DropTerm>& terms, std::vector<std::string> given) {
  for (std::string& name : given) name = term_name(terms, name);
  return given;
}
template <class Value>
void name_terms(const identify::Terms<tools::DropTerm>& terms, std::map<std::string, Value>& given) {
  std::map<std::string, Value> out;
  for (const auto& [name, value] : given) out[term_name(terms, name)] = value;
  given = std::move(out);
}

struct RobotArguments : Arguments {
  PyController controller = {};
  std::vector<std::string> per_run = {};
};
const Argument kController{"controller", &RobotArguments::controller};

/// A fit, or without free names a prediction.
RobotIdentified identified(RobotArguments a, const DrivenRobot& robot, const std::vector<RobotTrial>& given) {
  if (given.empty()) throw InputError("trials: at least one is needed");
  std::vector<RobotTrial> trials = controlled(given, a.controller);
  std::vector<std::string> warnings = tools::force_doubts(robot, trials);
  for (std::string& note : tools::remove_flat_columns(robot.scene.robot, trials)) warnings.push_back(std::move(note));
  const auto terms = tools::robot_terms(robot, trials);
  if (a.free) a.free = term_names(terms, *a.free);
  name_terms(terms, a.priors), name_terms(terms, a.lower), name_terms(terms, a.upper), name_terms(terms, a.errors);
  a.profile = term_names(terms, a.profile), a.nuisance = terms.nuisance;
  RobotFitOptions o = fit_options(RobotFitOptions(), terms, a);
  o.threads = a.threads, o.restarts = a.starts;
  tools::fit_per_run(term_names(terms, a.per_run), trials, o);
  RobotIdentified out{
      monitored([&] { return a.free ? tools::fit_robot(robot, trials, o) : tools::predict_robot(robot, trials, o); },
                o.monitor),
      trials};
  out.fit.warnings.insert(out.fit.warnings.begin(), warnings.begin(), warnings.end());
  return out;
}

}  // namespace

void bind_robot_trials(py::module_& m) {
  bind_robot(m), bind_trials_of(m), bind_result(m);
  define(
      m, "identify_robot",
      [](RobotArguments a, const DrivenRobot& robot, const std::vector<RobotTrial>& trials,
         const std::vector<std::string>& free) {
        a.free = free;
        return identified(std::move(a), robot, trials);
      },
      py::arg("robot"), py::arg("trials"), py::arg("free"), kPriors, kLower, kUpper, kStarts, kSeed, kThreads,
      kController, kProfile, kErrors, Argument{"per_run", &RobotArguments::per_run},
      "Fits constants of a robot of links to trials, as `ukemi identify --robot`, with how each trial starts. free: "
      "names as \"drive.hip.friction\"; starts: further ones, drawn; profile: constants whose likelihood profile is "
      "made; errors: standard deviations of constants that are not fitted, which count in all errors and verdicts; "
      "where neither the robot nor they say how late an elastic drive is, 1 ms of its control_delay and "
      "velocity_filter do; per_run: of `free`, those that each log has for its own, \"NAME@1\" of the first; `.robot` "
      "has their mean. controller: f(t, phi, dphi) -> torques, asked at each row of a log for what it adds to the "
      "torque of each joint [Nm], from the log's clock [s], the angles [rad] and rates [rad/s] of all joints of the "
      "file; it acts as a row's command does.");
  define(
      m, "predict_robot", &identified, py::arg("robot"), py::arg("trials"), kThreads, kController,
      "The trials for the robot's constants, as `ukemi predict --robot`; only how each starts is fitted. controller: "
      "as of identify_robot.");
}

}  // namespace ukemi::python

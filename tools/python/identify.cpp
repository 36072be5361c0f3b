// Rig, trials and fits for Python.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "common/csv.hpp"
#include "identify/logs/drive_command.hpp"
#include "identify/logs/hits.hpp"
#include "tools/program/trials.hpp"
#include "tools/python/bind.hpp"
#include "tools/report/identify.hpp"

namespace ukemi::python {

using namespace identify;

namespace {

using tools::IdentifyQuestion;

Trial trial_of(const Numbers& t, const std::optional<Numbers>& phi, const std::optional<Numbers>& force,
               const std::optional<Numbers>& phi_ref, const std::optional<Numbers>& dphi_ref,
               const std::optional<Numbers>& phi_motor, const std::optional<Numbers>& torque,
               const std::optional<Numbers>& command, bool multi_turn, const std::string& name) {
  Trial out;
  out.file = name;
  out.t = column("t", t);
  const auto load = [&](const char* what, const std::optional<Numbers>& from, std::vector<double>& to, bool one_turn) {
    to = column(what, from, out.t.size());
    for (std::size_t i = 0; i < to.size() && one_turn; ++i)
      if (std::abs(to[i]) > 2 * std::numbers::pi)
        throw InputError(fmt::format("{}: {}[{}]: {}: an angle within 2 pi rad, or multi_turn=True, is needed", name,
                                     what, i, shortest(to[i])));
  };
  load("phi", phi, out.phi, !multi_turn), load("force", force, out.force, false);
  load("phi_ref", phi_ref, out.phi_ref, !multi_turn), load("dphi_ref", dphi_ref, out.dphi_ref, false);
  load("phi_motor", phi_motor, out.phi_motor, !multi_turn), load("torque", torque, out.torque, false);
  load("command", command, out.command, false);
  if (out.force.empty() && out.phi_ref.empty() && out.command.empty())
    throw InputError(name + ": no force, no phi_ref and no command: at least one excitation is needed");
  count_from_first(out);
  out.validate();
  return out;
}

/// The trials as the verbs take them: the force at rest between hits, the command as the rig's drive gives it.
std::vector<Trial> prepared(std::vector<Trial> trials, const Rig& rig, std::optional<double> force_noise) {
  checked("force_noise", force_noise, Range::non_negative());
  for (Trial& t : trials) rest_between_hits(t, force_noise), t.command = drive_command(t, rig.drive);
  return trials;
}

/// An answer with what was asked, for figures and the actuator.
struct Identified {
  IdentifyQuestion question;
  Identification found;
  std::optional<Judgement> judgement = {};  ///< of a prediction
};

Figure trial_figure(const Identified& i, std::size_t trial) {
  if (trial >= i.question.trials.size())
    throw InputError(fmt::format("trial: {}: 0 to {} is needed", trial, i.question.trials.size() - 1));
  return {tools::lines_svg("t [s]", "phi_1 [rad]",
                           tools::angle_curves(i.question.trials[trial], i.found.fit.trials[trial]))};
}

Identified identify_trials(const std::vector<Trial>& trials, const Rig& rig, const std::optional<Actuator>& start,
                           const FitOptions& options, const TrustOptions& trust, std::optional<double> force_noise) {
  Identified out{{.rig = rig, .trials = prepared(trials, rig, force_noise), .options = options, .given = start}, {}};
  out.question.base = tools::base_of(rig, start);
  options.validate();
  if (!start)
    for (const char* name : kConstantNames)
      if (!options.terms.fits(name))
        throw InputError(fmt::format("free: {} is not free and needs a value: give start", name));
  tools::choose_drive(out.question);
  const auto from = start ? std::optional(start->sea) : std::nullopt;
  out.found = long_call([&](const std::function<bool()>& stop) {
    out.question.options.monitor.stop = stop;
    return identify::identify({out.question.rig, out.question.trials, out.question.options}, from, out.question.base,
                              trust);
  });
  out.question.options.monitor = {};
  return out;
}

/// None: at the reference; a number [rad]; "fit".
InitialState initial_state(const py::object& start_angle) {
  using Kind = InitialState::Kind;
  if (start_angle.is_none()) return {};
  if (py::isinstance<py::str>(start_angle)) {
    if (const auto text = start_angle.cast<std::string>(); text != "fit")
      throw InputError("start_angle: " + quoted(text) + ": a number [rad], \"fit\" or None is needed");
    return {Kind::kFitted};
  }
  return {Kind::kGiven, *checked("start_angle", std::optional(start_angle.cast<double>()), Range::any())};
}

Identified predict_trials(const std::vector<Trial>& trials, const Rig& rig, const Actuator& actuator, double accuracy,
                          std::optional<double> force_noise, bool multi_turn, const py::object& start_angle) {
  const InitialState start = initial_state(start_angle);
  Identified out{{.verb = IdentifyQuestion::Verb::kPredict,
                  .rig = rig,
                  .trials = prepared(trials, rig, force_noise),
                  .options = {.accuracy = accuracy, .escape = multi_turn ? Term::kInfinity : kEscape},
                  .given = actuator},
                 {}};
  out.question.base = tools::base_of(rig, actuator);
  tools::choose_drive(out.question);
  out.question.options.validate();
  const py::gil_scoped_release release;
  out.question.trials = identify::with_nearer_force(rig, out.question.trials, out.question.base, out.question.options);
  if (!trials.empty()) out.found.force_smooth = out.question.trials.front().force_smooth;
  Actuator mounted = actuator;
  mounted.sea = out.question.base;
  Prediction prediction = identify::predict({rig, out.question.trials, out.question.options}, mounted, start);
  out.found.fit = std::move(prediction.fit), out.judgement = std::move(prediction.judgement);
  return out;
}

double RigErrors::*error_named(const std::string& name) {
  std::vector<std::string> known;
  for (const RigErrorKey& k : rig_error_keys()) {
    if (k.key == name) return k.at;
    known.emplace_back(k.key);
  }
  throw InputError("RigErrors: " + one_of(name, known));
}
double error_of(const py::handle& name, const py::handle& value) {
  return *checked(py::str(name), std::optional(value.cast<double>()), Range::non_negative());
}

void bind_inputs(py::module_& m) {
  py::class_<RigErrors> bound(m, "RigErrors",
                              "Standard deviations of what a rig states: terms that are not fitted count with them.");
  bound
      .def(py::init([](const py::kwargs& given) {
             RigErrors out;
             for (const auto& [name, value] : given) out.*error_named(py::str(name)) = error_of(name, value);
             return out;
           }),
           "inertia, length, force_gain, encoder_gain [parts of the value], delay, filter, time_shift [s]; what is not "
           "given: 0.01, 0.005, 0.01, 0.001, 1e-3, 1e-3, 0.")
      .def_static("exact", &RigErrors::exact, "All are 0: simulated logs.");
  for (const RigErrorKey& k : rig_error_keys())
    bound.def_readonly(
        k.key, k.at,
        k.unit == RigErrorKey::Unit::kPart ? "Standard deviation [part of the value]." : "Standard deviation [s].");
  py::class_<Rig>(m, "Rig", "The rig of the impact tests: one link on a fixed base, in the horizontal plane.")
      .def(py::init([](double length, double inertia, std::optional<double> tau_max, std::optional<double> gear_ratio,
                       std::optional<Feedback> feedback, std::optional<double> speed_max,
                       std::optional<double> motor_torque_max, const RigErrors& errors) {
             return Rig{.length = checked("length", length, Range::positive()),
                        .inertia = checked("inertia", inertia, Range::positive()),
                        .tau_max = checked("tau_max", tau_max, Range::non_negative()),
                        .gear_ratio = checked("gear_ratio", gear_ratio, Range::positive()),
                        .feedback = feedback,
                        .speed_max = checked("speed_max", speed_max, Range::positive()),
                        .motor_torque_max = checked("motor_torque_max", motor_torque_max, Range::positive()),
                        .errors = errors};
           }),
           "length [m] from the joint to where the force acts, inertia of the link about the joint [kg m^2], tau_max "
           "[Nm] of the spring; speed_max [rad/s] and motor_torque_max [Nm], the motor's ratings; errors of all this. "
           "Without feedback identify fits both sides.",
           py::arg("length"), py::arg("inertia"), py::arg("tau_max") = py::none(), py::arg("gear_ratio") = py::none(),
           py::arg("feedback") = py::none(), py::arg("speed_max") = py::none(),
           py::arg("motor_torque_max") = py::none(), py::arg_v("errors", RigErrors{}, "RigErrors()"))
      .def_readonly("length", &Rig::length, "From the joint to where the force acts [m].")
      .def_readonly("inertia", &Rig::inertia, "Of the link about the joint [kg m^2].")
      .def_readonly("errors", &Rig::errors, "Of what it states.")
      .def_readonly("tau_max", &Rig::tau_max, "Limit of the spring's torque [Nm], or None.");
  m.def("read_rig", &read_rig, py::arg("path"), "Reads a rig file (TOML).");

  py::class_<Trial> c(m, "Trial", "One logged trial.");
  c.def(py::init(&trial_of),
        "Times t [s], kept from the first on (t_origin); measured angles phi and phi_motor [rad], force at the link's "
        "tip [N], reference phi_ref [rad] and "
        "dphi_ref [rad/s], measured torque of the spring [Nm], command [V, A or Nm]: arrays as long as t, or None. "
        "multi_turn: angles beyond 2 "
        "pi are meant.",
        py::arg("t"), py::arg("phi") = py::none(), py::arg("force") = py::none(), py::arg("phi_ref") = py::none(),
        py::arg("dphi_ref") = py::none(), py::arg("phi_motor") = py::none(), py::arg("torque") = py::none(),
        py::arg("command") = py::none(), py::arg("multi_turn") = false, py::arg("name") = "trial");
  const std::pair<const char*, std::pair<std::vector<double> Trial::*, const char*>> kept[] = {
      {"t", {&Trial::t, "Times [s]."}},
      {"phi", {&Trial::phi, "Measured output angle [rad]."}},
      {"force", {&Trial::force, "Force at the link's tip [N]."}},
      {"phi_ref", {&Trial::phi_ref, "Reference [rad]."}},
      {"phi_motor", {&Trial::phi_motor, "Measured angle of the motor at the output side [rad]."}},
      {"torque", {&Trial::torque, "Measured torque of the spring [Nm]."}},
      {"command", {&Trial::command, "What the motor was told [V, A or Nm]."}}};
  for (const auto& [name, what] : kept)
    c.def_property_readonly(
        name, [member = what.first](const py::object& self) { return view(self.cast<const Trial&>().*member, self); },
        what.second);
  c.def_readonly("t_origin", &Trial::t_origin, "What the log's clock read at t = 0, its first row [s].")
      .def_readonly("name", &Trial::file, "Its file, or the name that it was given.")
      .def_readonly("notes", &Trial::notes, "What was handled while reading, a sentence each.");
  m.def(
      "read_trial",
      [](const std::string& path, const std::string& columns, const std::string& module,
         std::optional<double> gear_ratio) {
        tools::TrialArguments a;
        a.columns = columns, a.module = module;
        Rig rig{};
        rig.gear_ratio = checked("gear_ratio", gear_ratio, Range::positive());
        tools::Json modules;
        return tools::read_any(
            path, a, {.columns = columns, .require_phi = false, .gear_ratio = gear_ratio.value_or(1)}, rig, modules);
      },
      py::arg("path"), py::arg("columns") = "", py::arg("module") = "", py::arg("gear_ratio") = py::none(),
      "Reads a trial: CSV (t [s], phi [rad], force [N], phi_ref [rad]), or a HEBI log. columns as the program's "
      "--columns.");
}

}  // namespace

void bind_identify(py::module_& m) {
  bind_inputs(m);
  py::class_<TrialResult>(m, "TrialFit", "A trial as the constants predict it.")
      .def_readonly("name", &TrialResult::file, "Of the trial.")
      .def_readonly("rms", &TrialResult::rms, "Of the residual [rad].")
      .def_readonly("noise", &TrialResult::noise, "The log's own noise [rad].")
      .def_property_readonly(
          "phi", [](const py::object& self) { return view(self.cast<const TrialResult&>().phi, self); },
          "Predicted output angle [rad].")
      .def_property_readonly(
          "phi_motor", [](const py::object& self) { return view(self.cast<const TrialResult&>().phi_m, self); },
          "Predicted angle of the motor [rad].")
      .def_property_readonly(
          "torque", [](const py::object& self) { return view(self.cast<const TrialResult&>().torque, self); },
          "Predicted torque of the spring [Nm].");
  py::class_<Identified> c(m, "Identification", "A fit of the actuator's constants, and how far it can be trusted.");
  bind_estimates(
      c, +[](const Identified& i) -> const Estimates& { return i.found.fit; });
  c.def_property_readonly(
       "actuator", [](const Identified& i) { return tools::fitted_actuator(i.question, i.found.fit); },
       "The constants with covariance and verdicts, as actuator.toml has them.")
      .def_property_readonly(
          "rms", [](const Identified& i) { return i.found.fit.rms; }, "Of the residuals [rad].")
      .def_property_readonly(
          "identifiable", [](const Identified& i) { return i.found.fit.identifiable; },
          "Whether the trials determine every fitted constant.")
      .def_property_readonly(
          "error_budget",
          [](const Identified& i) {
            std::map<std::string, std::map<std::string, double>> out;
            for (const ErrorBudget& b : error_budget(i.found.fit)) out[b.constant] = {b.shares.begin(), b.shares.end()};
            return out;
          },
          "Of each constant the shares of its variance [1]: noise, and what the rig states an error of.")
      .def_property_readonly(
          "feedback", [](const Identified& i) { return i.found.fit.sea.feedback; },
          "What the drive feeds back: the rig's, else the side whose fit is better.")
      .def_property_readonly(
          "model_rejected", [](const Identified& i) { return i.found.trust && i.found.trust->tests.model_rejected(); },
          "Whether the residuals speak against the model.")
      .def_property_readonly(
          "trials",
          [](const py::object& self) {
            py::list out;
            for (const TrialResult& t : self.cast<const Identified&>().found.fit.trials)
              out.append(py::cast(t, py::return_value_policy::reference_internal, self));
            return out;
          },
          "Each trial as predicted, a TrialFit.")
      .def_property_readonly(
          "error_factor",
          [](const Identified& i) { return i.judgement ? std::optional(i.judgement->factor) : std::nullopt; },
          "Of a prediction [1]: its error over what the logs' noise and the constants' errors allow for; at most 1: it "
          "holds. "
          "None of a fit, NaN where too little is measured.")
      .def("figure", &trial_figure, py::arg("trial") = 0,
           "Angles of a trial [rad] over time [s], measured and predicted.")
      .def(
          "_repr_svg_", [](const Identified& i) { return trial_figure(i, 0).svg; }, "What a notebook shows.")
      .def("__repr__", [](const Identified& i) {
        return fmt::format("<ukemi.Identification of {} trials, rms {:.3g} rad{}>", i.question.trials.size(),
                           i.found.fit.rms, i.found.fit.trusted() ? ", trusted" : "");
      });
  m.def(
      "identify",
      [](const std::vector<Trial>& trials, const Rig& rig, const std::optional<Actuator>& start,
         const std::optional<std::vector<std::string>>& free, const std::vector<std::string>& nuisance,
         const Priors& priors, const Bounds& lower, const Bounds& upper, double huber, bool trial_weights,
         double accuracy, std::optional<double> force_noise, bool multi_turn, int starts, bool diagnose,
         const std::vector<std::string>& profile, std::uint64_t seed, int threads) {
        FitOptions o;
        o.terms = choose(std::move(o.terms), free, nuisance, priors, lower, upper);
        if (multi_turn) o.escape = Term::kInfinity;
        o.huber = huber, o.accuracy = accuracy, o.explore = starts, o.seed = seed, o.threads = threads;
        if (trial_weights) o.weights = FitOptions::Weights::kTrial;
        using enum TrustOptions::Depth;
        return identify_trials(trials, rig, start, o,
                               {.depth = diagnose ? kRefit : kResiduals, .profiles = profile, .threads = threads},
                               force_noise);
      },
      py::arg("trials"), py::arg("rig"), py::arg("start") = py::none(), py::arg("free") = py::none(),
      py::arg("nuisance") = std::vector<std::string>{}, py::arg("priors") = Priors{}, py::arg("lower") = Bounds{},
      py::arg("upper") = Bounds{}, py::arg("huber") = 0.0, py::arg("trial_weights") = false, py::arg("accuracy") = 1e-9,
      py::arg("force_noise") = py::none(), py::arg("multi_turn") = false, py::arg("starts") = 0,
      py::arg("diagnose") = false, py::arg("profile") = std::vector<std::string>{}, py::arg("seed") = 1,
      py::arg("threads") = 0,
      "Fits the actuator's constants to impact trials, as `ukemi identify`. free: names of the constants that are "
      "fitted "
      "(None: all); priors: name -> (value, standard deviation); lower, upper: name -> bound, each in the term's unit; "
      "huber "
      "[rad]; force_noise [N]; threads 0: all cores.");
  m.def("predict", &predict_trials, py::arg("trials"), py::arg("rig"), py::arg("actuator"), py::arg("accuracy") = 1e-9,
        py::arg("force_noise") = py::none(), py::arg("multi_turn") = false, py::arg("start_angle") = py::none(),
        "The rig's motion for given constants [rad] beside each trial's log, and whether it holds (error_factor); as "
        "`ukemi predict`. start_angle: None, a number [rad], or \"fit\".");
}

}  // namespace ukemi::python

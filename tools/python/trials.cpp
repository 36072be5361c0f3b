// Python bindings of rig and trials.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "common/csv.hpp"
#include "identify/logs/drive_command.hpp"
#include "identify/logs/hits.hpp"
#include "tools/program/trials.hpp"
#include "tools/python/arguments.hpp"

namespace ukemi::python {

using namespace identify;

std::vector<Trial> prepared(std::vector<Trial> trials, const Rig& rig, std::optional<double> force_noise) {
  checked("force_noise", force_noise, Range::non_negative());
  for (Trial& t : trials) flatten_force_between_hits(t, force_noise), t.command = drive_command(t, rig.drive);
  return trials;
}

namespace {

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

double RigErrors::*error_named(const std::string& name) {
  std::vector<std::string> known;
  for (const RigErrorKey& k : rig_error_keys()) {
    if (k.key == name) return k.at;
    known.emplace_back(k.key);
  }
  throw InputError("RigErrors: " + one_of(name, known));
}
double error_of(const py::handle& name, const py::handle& value) {
  return checked(py::str(name), number(py::str(name), value), Range::non_negative());
}

void bind_rig_errors(py::module_& m) {
  Value<RigErrors> bound(m, "RigErrors",
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
}

void bind_rig(py::module_& m) {
  Value<Rig> c(m, "Rig", "The rig of the impact tests: one link on a fixed base, in the horizontal plane.");
  define_constructor(
      c,
      [](Rig r, double length, double inertia) {
        r.length = checked("length", length, Range::positive());
        r.inertia = checked("inertia", inertia, Range::positive());
        checked("tau_max", r.tau_max, Range::non_negative()), checked("gear_ratio", r.gear_ratio, Range::positive());
        checked("speed_max", r.speed_max, Range::positive());
        checked("motor_torque_max", r.motor_torque_max, Range::positive());
        return r;
      },
      "length [m] from the joint to where the force acts, inertia of the link about the joint [kg m^2], tau_max [Nm] "
      "of the spring; speed_max [rad/s] and motor_torque_max [Nm], the motor's ratings; errors of all this. Without "
      "feedback identify fits both sides.",
      py::arg("length"), py::arg("inertia"), Argument{"tau_max", &Rig::tau_max},
      Argument{"gear_ratio", &Rig::gear_ratio}, Argument{"feedback", &Rig::feedback},
      Argument{"speed_max", &Rig::speed_max}, Argument{"motor_torque_max", &Rig::motor_torque_max},
      Argument{"errors", &Rig::errors, "RigErrors()"});
  c.def_readonly("length", &Rig::length, "From the joint to where the force acts [m].")
      .def_readonly("inertia", &Rig::inertia, "Of the link about the joint [kg m^2].")
      .def_readonly("errors", &Rig::errors, "Of what it states.")
      .def_readonly("tau_max", &Rig::tau_max, "Limit of the spring's torque [Nm], or None.");
  bind_reader(m, "read_rig", "Reads a rig file (TOML).", [](const Path& path) { return read_rig(path); });
}

void bind_trial(py::module_& m) {
  Value<Trial> c(m, "Trial", "One logged trial.");
  c.def(py::init(&trial_of),
        "Times t [s], kept from the first on (t_origin); measured angles phi and phi_motor [rad], force at the link's "
        "tip [N], reference phi_ref [rad] and dphi_ref [rad/s], measured torque of the spring [Nm], command [V, A or "
        "Nm]: arrays as long as t, or None. multi_turn: angles beyond 2 pi are meant.",
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
  for (const auto& [name, what] : kept) column_property(c, name, what.second, what.first);
  c.def_readonly("t_origin", &Trial::t_origin, "What the log's clock read at t = 0, its first row [s].")
      .def_readonly("name", &Trial::file, "Its file, or the name that it was given.")
      .def_readonly("notes", &Trial::notes, "What was handled while reading, a sentence each.");
  m.def(
      "read_trial",
      [](const Path& path, const std::string& columns, const std::string& module, std::optional<double> gear_ratio) {
        tools::TrialArguments a;
        a.columns = columns, a.module = module;
        Rig rig{};
        rig.gear_ratio = checked("gear_ratio", gear_ratio, Range::positive());
        tools::Json modules;
        return tools::read_trial_file(
            path, a, {.columns = columns, .require_phi = false, .gear_ratio = gear_ratio.value_or(1)}, rig, modules);
      },
      py::arg("path"), py::arg("columns") = "", py::arg("module") = "", py::arg("gear_ratio") = py::none(),
      "Reads a trial: CSV (t [s], phi [rad], force [N], phi_ref [rad]), or a HEBI log. columns as the program's "
      "--columns.");
}

}  // namespace

void bind_trials(py::module_& m) { bind_rig_errors(m), bind_rig(m), bind_trial(m); }

}  // namespace ukemi::python

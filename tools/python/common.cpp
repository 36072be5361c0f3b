// Python bindings of errors, arrays, figures and the actuator.
#include <fmt/format.h>

#include "common/actuator_constants.hpp"
#include "common/checks.hpp"
#include "common/csv.hpp"
#include "common/eigen.hpp"
#include "common/files.hpp"
#include "tools/program/output.hpp"
#include "tools/python/arguments.hpp"

namespace ukemi::python {

double checked(const std::string& what, double value, const Range& range) {
  if (range.holds(value)) return value;
  throw InputError(fmt::format("{}: {}: must be {}", what, shortest(value), range.rule));
}
std::optional<double> checked(const std::string& what, std::optional<double> value, const Range& range) {
  if (value) checked(what, *value, range);
  return value;
}

std::optional<Path> path_of(py::handle given) {
  PyObject* bytes = nullptr;  // the file system's encoding
  if (PyUnicode_FSConverter(given.ptr(), &bytes) != 0)
    return Path{py::reinterpret_steal<py::bytes>(bytes).cast<std::string>()};
  const bool no_name = PyErr_ExceptionMatches(PyExc_ValueError) != 0;
  PyErr_Clear();
  if (no_name) throw InputError("path: " + py::repr(given).cast<std::string>() + ": a name of a file is needed");
  return std::nullopt;
}

double number(const std::string& what, py::handle value) {
  const double out = PyFloat_AsDouble(value.ptr());
  if (!PyErr_Occurred()) return out;
  PyErr_Clear();
  throw InputError(what + ": " + py::repr(value).cast<std::string>() + ": a number is needed");
}

void refuse_masked(py::handle array) {
  if (py::hasattr(array, "mask") && py::module_::import("numpy.ma").attr("is_masked")(array).cast<bool>())
    throw InputError("an array with masked values: they are no numbers; fill them, or leave their samples out");
}

std::vector<double> column(const std::string& what, const Numbers& numbers, std::size_t rows) {
  const AnyNumbers& a = numbers.array;
  if (a.ndim() != 1)
    throw InputError(fmt::format("{}: {} dimensions: an array of one dimension is needed", what, a.ndim()));
  if (rows > 0 && std::size_t(a.size()) != rows)
    throw InputError(fmt::format("{}: {} values: {} are needed, one for each time", what, a.size(), rows));
  return {a.data(), a.data() + a.size()};
}
std::vector<double> column(const std::string& what, const std::optional<Numbers>& numbers, std::size_t rows) {
  return numbers ? column(what, *numbers, rows) : std::vector<double>{};
}

py::array_t<double> view(const double* first, std::size_t count, std::size_t stride, py::handle owner) {
  if (count == 0) return py::array_t<double>(0);
  py::array_t<double> out({py::ssize_t(count)}, {py::ssize_t(stride)}, first, owner);
  out.attr("setflags")(false);  // results are read-only
  return out;
}

namespace {

using identify::Estimate;

/// What an actuator may be given beside its five constants.
struct ActuatorArguments : SeaParameters<double> {
  std::string name = {};
  std::optional<double> speed_max = {}, motor_torque_max = {};
};
Actuator actuator_of(const ActuatorArguments& a, double k_p, double k_d, double k_sea, double c_sea, double i_motor) {
  Actuator out;
  out.name = a.name, out.sea = a;
  set_constants(out.sea, std::array{k_p, k_d, k_sea, c_sea, i_motor});
  out.speed_max = a.speed_max, out.motor_torque_max = a.motor_torque_max;
  validate(out);
  return out;
}

void bind_actuator(py::module_& m) {
  py::enum_<Feedback>(m, "Feedback", "Which angle Eq. 3 feeds back.")
      .value("output", Feedback::kOutput)
      .value("motor", Feedback::kMotor);
  Value<Actuator> c(m, "Actuator", "The constants of a series elastic actuator (Eq. 2-4), and its ratings.");
  using Given = ActuatorArguments;
  define_constructor(
      c, &actuator_of,
      "k_p [Nm/rad], k_d [Nm/(rad/s)], k_sea [Nm/rad], c_sea [Nm/(rad/s)], i_motor [kg m^2]; tau_max [Nm] limits the "
      "spring, infinite: no limit; speed_max [rad/s], motor_torque_max [Nm] rate the motor, None: unknown; friction "
      "[Nm], viscous_friction [Nm/(rad/s)], k_sea_cubic [Nm/rad^3], below 0: softening; control_delay, "
      "velocity_filter [s], how late the drive is. Others as in an actuator file: k_t [Nm], output_friction [Nm], "
      "output_viscous [Nm/(rad/s)], stribeck_speed [rad/s]; friction_asymmetry, output_friction_asymmetry, breakaway, "
      "spring_loss [1].",
      py::arg("k_p"), py::arg("k_d"), py::arg("k_sea"), py::arg("c_sea"), py::arg("i_motor"),
      Argument{"tau_max", &Given::tau_max, "float('inf')"}, Argument{"speed_max", &Given::speed_max},
      Argument{"friction", &Given::friction}, Argument{"viscous_friction", &Given::viscous},
      Argument{"k_sea_cubic", &Given::k_sea_cubic}, Argument{"feedback", &Given::feedback, "Feedback.output"},
      Argument{"name", &Given::name}, Argument{"motor_torque_max", &Given::motor_torque_max},
      Argument{"control_delay", &Given::control_delay}, Argument{"velocity_filter", &Given::velocity_filter},
      Argument{"k_t", &Given::k_t}, Argument{"friction_asymmetry", &Given::friction_asymmetry},
      Argument{"output_friction", &Given::output_friction},
      Argument{"output_friction_asymmetry", &Given::output_friction_asymmetry},
      Argument{"output_viscous", &Given::output_viscous}, Argument{"breakaway", &Given::breakaway},
      Argument{"stribeck_speed", &Given::stribeck_speed}, Argument{"spring_loss", &Given::spring_loss});
  for (const ActuatorConstant& constant : actuator_constants())
    property(c, constant.key, fmt::format("{} [{}].", constant.meaning, constant.unit).c_str(),
             [at = constant.at](auto& a) { return a.sea.*at; });
  c.def_readonly("name", &Actuator::name, "What it is called.")
      .def_readonly("speed_max", &Actuator::speed_max, "Rated speed of the motor at the output [rad/s], or None.")
      .def_readonly("motor_torque_max", &Actuator::motor_torque_max,
                    "Rated torque of the motor at the output [Nm], or None.");
  property(c, "feedback", "Which angle Eq. 3 feeds back.", [](auto& a) { return a.sea.feedback; });
  c.def_readonly("uncertain", &Actuator::uncertain, "The constants that a fit found, in the order of `covariance`.");
  property(c, "covariance", "Covariance of `uncertain` [product of their units].",
           [](auto& a) -> Eigen::MatrixXd { return eigen(a.covariance); });
  property(c, "verdicts", "How far the fit that found a constant may be relied on, by its name.",
           [](auto& a) { return std::map<std::string, std::string>(a.verdicts.begin(), a.verdicts.end()); });
  c.def("standard_error", &Actuator::standard_error, py::arg("constant"),
        "Standard error of a constant [its unit], or None.");
  c.repr([](auto& a) {
    return fmt::format(" '{}': k_p {:.6g}, k_d {:.6g}, k_sea {:.6g}, c_sea {:.6g}, i_motor {:.6g}", a.name, a.sea.k_p,
                       a.sea.k_d, a.sea.k_sea, a.sea.c_sea, a.sea.i_motor);
  });
  bind_file(c, "an actuator file", [](const Actuator& a) { return to_toml(a); });
  bind_reader(m, "read_actuator", "Reads an actuator file (TOML).",
              [](const Path& path) { return read_actuator(path); });
}

}  // namespace

void bind_common(py::module_& m) {
  py::register_exception<InputError>(m, "InputError", PyExc_ValueError).attr("__doc__") =
      "Bad input: where, what, the value and the rule, on one line.";
  m.def("dataset", &tools::dataset, py::arg("name"), "Path of a file of the shipped data, as \"scenes/paper.toml\".");
  Value<Figure> figure(m, "Figure", "A picture; notebooks show it by themselves.");
  figure.def_readonly("svg", &Figure::svg, "Its text (SVG).")
      .def(
          "save", [](const Figure& f, const Path& path) { write_file(path, f.svg); }, py::arg("path"),
          "Writes it as an SVG file.")
      .def(
          "_repr_svg_", [](const Figure& f) { return f.svg; }, "What a notebook shows.");
  Value<Estimate> estimate(m, "Estimate", "What a fit came to for one term.");
  estimate.def_readonly("name", &Estimate::name, "The term.")
      .def_readonly("unit", &Estimate::unit, "Its unit.")
      .def_readonly("value", &Estimate::value, "Its value [unit].")
      .def_readonly("std", &Estimate::std, "Standard error [unit], or None where it cannot be estimated.")
      .def_readonly("std_noise", &Estimate::std_noise,
                    "The part of it that is the logs' noise [unit]; the rest are errors that the rig states.");
  property(estimate, "ci95", "95 % interval [unit], or None.",
           [](auto& e) { return e.std ? std::optional(std::pair(e.ci_low, e.ci_high)) : std::nullopt; });
  estimate.def_readonly("at_bound", &Estimate::at_bound, "Whether it stands at a bound.")
      .def_readonly("free", &Estimate::free, "Whether it was fitted.");
  property(estimate, "verdict",
           "How far a constant may be relied on: trusted, weak, not identifiable, at its bound, fixed; of what was "
           "fitted along: fitted.",
           [](auto& e) { return name(e.verdict); });
  estimate.def("__float__", [](const Estimate& e) { return e.value; });
  estimate.repr([](auto& e) {
    return fmt::format(" {} {:.6g}{} {}", e.name, e.value, e.std ? fmt::format(" +- {:.2g}", *e.std) : "", e.unit);
  });
  bind_actuator(m);
}

}  // namespace ukemi::python

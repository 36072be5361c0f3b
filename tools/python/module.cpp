// The Python module `ukemi`: functions named like the program's verbs.
#include "tools/python/bind.hpp"

namespace ukemi::python {

void build(py::module_& m) {
  py::options options;
  options.disable_enum_members_docstring();
  m.doc() =
      "ukemi: identify a series elastic actuator, plan the landing that it should make.\n\n"
      "SI units: m, s, rad, N, Nm, kg; what ends in _deg is in degrees. Bad input raises InputError. Long calls free "
      "the interpreter and end at Ctrl-C.";
  m.attr("__version__") = UKEMI_VERSION;
  bind_common(m), bind_scene(m), bind_trials(m), bind_identify(m), bind_robot_trials(m), bind_design(m);
  bind_landing(m), bind_optimize(m), bind_risk(m), bind_map(m), bind_planner(m), bind_calibrate(m), bind_compare(m);
  bind_atlas(m), bind_trade(m), bind_report(m);
}

}  // namespace ukemi::python

PYBIND11_MODULE(ukemi, m) { ukemi::python::build(m); }

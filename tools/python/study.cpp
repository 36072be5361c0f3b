// Logs of drops and the calibration of the floor for Python.
#include <fmt/format.h>

#include <cmath>

#include "common/actuator.hpp"
#include "common/csv.hpp"
#include "common/files.hpp"
#include "landing/model/scene_file.hpp"
#include "tools/python/bind.hpp"
#include "tools/study/calibration.hpp"

namespace ukemi::python {

using namespace landing;

namespace {

using tools::Calibration, tools::LoggedDrop, tools::DropResult;

DropLog log_of(const Numbers& t, const std::array<std::optional<Numbers>, kOutputs>& outputs, const std::string& name) {
  DropLog out;
  out.file = name;
  out.t = column("t", t);
  require_times("t", out.t);
  if (out.t.front() < 0)
    throw InputError(fmt::format("{}: t[0]: {}: times from the release on are needed", name, shortest(out.t.front())));
  for (std::size_t o = 0; o < kOutputs; ++o) {
    out.output[o] = column(kOutputNames[o], outputs[o], out.t.size());
    for (std::size_t i = 0; i < out.output[o].size(); ++i)
      if (std::isinf(out.output[o][i]))
        throw InputError(
            fmt::format("{}: {}[{}]: a number, or NaN where it was not measured, is needed", name, kOutputNames[o], i));
  }
  return out;
}

/// A log with how it was played; what is not said is the scene's.
struct PlayedDrop {
  DropLog log;
  Motion motion;
  std::optional<double> height, forward_speed;

  LoggedDrop thrown(const Scene& scene) const {
    LoggedDrop out{log, motion, scene.drop};
    out.thrown.height = height.value_or(scene.drop.height);
    out.thrown.forward_speed = forward_speed.value_or(scene.drop.forward_speed);
    return out;
  }
};

void bind_logs(py::module_& m) {
  py::class_<DropLog> c(m, "DropLog", "What was measured of the thigh in one drop.");
  c.def(py::init([](const Numbers& t, const std::optional<Numbers>& acc, const std::optional<Numbers>& ax,
                    const std::optional<Numbers>& ay, const std::optional<Numbers>& x_0,
                    const std::optional<Numbers>& y_0, const std::optional<Numbers>& phi_0, const std::string& name) {
          return log_of(t, {acc, ax, ay, x_0, y_0, phi_0}, name);
        }),
        "Times t from release [s]; |ddr_0| acc, its components ax and ay [m/s^2], the centre of mass x_0, y_0 [m], "
        "pitch "
        "phi_0 [rad]: arrays as long as t, NaN where not measured, or None.",
        py::arg("t"), py::arg("acc") = py::none(), py::arg("ax") = py::none(), py::arg("ay") = py::none(),
        py::arg("x_0") = py::none(), py::arg("y_0") = py::none(), py::arg("phi_0") = py::none(),
        py::arg("name") = "drop")
      .def_readonly("name", &DropLog::file, "Its file, or the name that it was given.")
      .def_property_readonly(
          "t", [](const py::object& self) { return view(self.cast<const DropLog&>().t, self); },
          "Times from release [s].");
  for (std::size_t o = 0; o < kOutputs; ++o)
    c.def_property_readonly(
        kOutputNames[o], [o](const py::object& self) { return view(self.cast<const DropLog&>().output[o], self); },
        fmt::format("Measured {} [{}]; empty where it was not.", kOutputNames[o], kOutputUnits[o]).c_str());
  m.def("read_drop", &read_drop, py::arg("path"), "Reads a log of a drop (CSV).");
  py::class_<PlayedDrop>(m, "Drop", "A log with the motion that was played, and how the robot was thrown.")
      .def(py::init([](const DropLog& log, const Motion& motion, std::optional<double> height,
                       std::optional<double> forward_speed) {
             return PlayedDrop{log, motion, checked("height", height, Range::non_negative()),
                               checked("forward_speed", forward_speed, Range::any())};
           }),
           "height [m] and forward_speed [m/s]; None: the scene's.", py::arg("log"), py::arg("motion"),
           py::arg("height") = py::none(), py::arg("forward_speed") = py::none())
      .def_readonly("log", &PlayedDrop::log, "What was measured.")
      .def_readonly("motion", &PlayedDrop::motion, "What was played.");
}

Calibration calibrated(const Scene& scene, const Actuator& actuator, const std::vector<PlayedDrop>& played,
                       tools::CalibrationOptions options) {
  options.validate();
  require_gains(actuator);
  std::vector<LoggedDrop> drops;
  for (const PlayedDrop& d : played) drops.push_back(d.thrown(scene));
  check_drops(scene, drops);
  return long_call([&](const std::function<bool()>& stop) {
    options.monitor.stop = stop;
    return tools::calibrate(scene, actuator.sea, drops, options);
  });
}

}  // namespace

void bind_study(py::module_& m) {
  bind_logs(m);
  py::class_<DropResult>(m, "DropFit", "One drop, simulated beside its log.")
      .def_readonly("name", &DropResult::file, "Of the log.")
      .def_readonly("peak_measured", &DropResult::peak_measured,
                    "Largest |ddr_0| of the log [m/s^2]; NaN: not measured.")
      .def_readonly("peak_simulated", &DropResult::peak_simulated, "Largest |ddr_0| at the log's samples [m/s^2].");
  py::class_<Calibration> c(m, "Calibration", "The floor's constants and the pitch, fitted to drops.");
  bind_estimates(
      c, +[](const Calibration& x) -> const identify::Estimates& { return x; });
  c.def_readonly("scene", &Calibration::scene, "The given scene with the fitted constants.")
      .def(
          "save", [](const Calibration& x, const std::string& path) { write_file(path, to_toml(x.scene, "")); },
          py::arg("path"), "Writes the scene's file, with the constants' verdicts.")
      .def_property_readonly(
          "model_rejected", [](const Calibration& x) { return x.tests.model_rejected(); },
          "Whether the residuals speak against the floor.")
      .def_readonly("drops", &Calibration::drops, "Each drop beside its log.")
      .def_property_readonly(
          "rms",
          [](const Calibration& x) {
            std::map<std::string, double> out;
            for (std::size_t o = 0; o < kOutputs; ++o)
              if (std::isfinite(x.noise[o])) out[kOutputNames[o]] = x.rms[o];
            return out;
          },
          "Residual of each output that was measured, by its name [m/s^2, m or rad].");
  m.def(
      "calibrate",
      [](const Scene& scene, const Actuator& actuator, const std::vector<PlayedDrop>& drops,
         const std::optional<std::vector<std::string>>& free, const std::vector<std::string>& nuisance,
         const Priors& priors, const Bounds& lower, const Bounds& upper, double accuracy, std::uint64_t seed) {
        tools::CalibrationOptions o;
        o.terms = choose(std::move(o.terms), free, nuisance, priors, lower, upper);
        o.accuracy = accuracy, o.seed = seed;
        return calibrated(scene, actuator, drops, std::move(o));
      },
      py::arg("scene"), py::arg("actuator"), py::arg("drops"), py::arg("free") = py::none(),
      py::arg("nuisance") = std::vector<std::string>{}, py::arg("priors") = Priors{}, py::arg("lower") = Bounds{},
      py::arg("upper") = Bounds{}, py::arg("accuracy") = 1e-9, py::arg("seed") = 1,
      "Fits the floor's constants and the pitch to logs of drops, as `ukemi calibrate`. free: of stiffness, "
      "damping_normal, damping_tangential, pitch (None: all); priors: name -> (value, standard deviation); lower, "
      "upper: "
      "name -> bound, each in the term's unit (pitch [rad]).");
}

}  // namespace ukemi::python

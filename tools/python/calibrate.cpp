// Python bindings of drop logs and the calibration of the floor.
#include <fmt/format.h>

#include <cmath>

#include "common/actuator.hpp"
#include "common/csv.hpp"
#include "landing/model/scene_file.hpp"
#include "tools/python/floor_fit.hpp"
#include "tools/python/landing.hpp"
#include "tools/study/calibration.hpp"

namespace ukemi::python {

using namespace landing;

std::vector<double> drop_times(const Numbers& t, const std::string& name) {
  std::vector<double> out = column("t", t);
  require_times("t", out);
  if (out.front() < 0)
    throw InputError(fmt::format("{}: t[0]: {}: times from the release on are needed", name, shortest(out.front())));
  return out;
}

std::vector<double> drop_output(const std::string& output, const std::optional<Numbers>& values, std::size_t rows,
                                const std::string& name) {
  std::vector<double> out = column(output, values, rows);
  for (std::size_t i = 0; i < out.size(); ++i)
    if (std::isinf(out[i]))
      throw InputError(
          fmt::format("{}: {}[{}]: a number, or NaN where it was not measured, is needed", name, output, i));
  return out;
}

std::map<std::string, double> rms_by_output(const tools::FloorFit& fit) {
  std::map<std::string, double> out;
  for (std::size_t o = 0; o < fit.channels.size(); ++o)
    if (std::isfinite(fit.noise[o])) out[fit.channels[o].name] = fit.rms[o];
  return out;
}

namespace {

using tools::Calibration, tools::LoggedDrop, tools::DropResult;

DropLog log_of(const Numbers& t, const std::array<std::optional<Numbers>, kOutputs>& outputs, const std::string& name) {
  DropLog out;
  out.file = name, out.t = drop_times(t, name);
  for (std::size_t o = 0; o < kOutputs; ++o)
    out.output[o] = drop_output(thigh_channels()[o].name, outputs[o], out.t.size(), name);
  return out;
}

/// A log with the played motion; an absent number is the scene's.
struct PlayedDrop {
  DropLog log;
  Motion motion;
  std::optional<double> height, forward_speed;

  LoggedDrop logged_drop(const Scene& scene) const {
    return {log, motion, dropped(scene.drop, {height, forward_speed})};
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
        "pitch phi_0 [rad]: arrays as long as t, NaN where not measured, or None.",
        py::arg("t"), py::arg("acc") = py::none(), py::arg("ax") = py::none(), py::arg("ay") = py::none(),
        py::arg("x_0") = py::none(), py::arg("y_0") = py::none(), py::arg("phi_0") = py::none(),
        py::arg("name") = "drop")
      .def_readonly("name", &DropLog::file, "Its file, or the name that it was given.");
  column_property(c, "t", "Times from release [s].", &DropLog::t);
  for (std::size_t o = 0; o < kOutputs; ++o) {
    const DropChannel& measured = thigh_channels()[o];
    column_property(
        c, measured.name.c_str(),
        fmt::format("Measured {} [{}]; empty where it was not.", measured.name, measured.unit), [o](auto& d) -> auto& {
          return d.output[o];
        });
  }
  bind_value(c);
  bind_reader(m, "read_drop", "Reads a log of a drop (CSV).", [](const Path& path) { return read_drop(path); });
}

void bind_drop(py::module_& m) {
  py::class_<PlayedDrop> c(m, "Drop", "A log with the motion that was played, and how the robot was thrown.");
  c.def(py::init([](const DropLog& log, const Motion& motion, std::optional<double> height,
                    std::optional<double> forward_speed) {
          return PlayedDrop{log, motion, checked("height", height, Range::non_negative()),
                            checked("forward_speed", forward_speed, Range::any())};
        }),
        "height [m] and forward_speed [m/s]; None: the scene's.", py::arg("log"), py::arg("motion"),
        py::arg("height") = py::none(), py::arg("forward_speed") = py::none())
      .def_readonly("log", &PlayedDrop::log, "What was measured.")
      .def_readonly("motion", &PlayedDrop::motion, "What was played.")
      .def_readonly("height", &PlayedDrop::height, "Of the drop [m]; None: the scene's.")
      .def_readonly("forward_speed", &PlayedDrop::forward_speed, "At release [m/s]; None: the scene's.");
  bind_value(c);
}

using Calibrated = CalibratedOf<tools::CalibratedDrops>;

void bind_drop_fit(py::module_& m) {
  py::class_<DropResult> c(m, "DropFit", "One drop, simulated beside its log.");
  c.def_readonly("name", &DropResult::file, "Of the log.")
      .def_readonly("peak_measured", &DropResult::peak_measured,
                    "Largest |ddr_0| of the log [m/s^2]; NaN: not measured.")
      .def_readonly("peak_simulated", &DropResult::peak_simulated, "Largest |ddr_0| at the log's samples [m/s^2].");
  bind_value(c);
}

void bind_paper_calibration(py::module_& m) {
  auto c = bind_calibration<Calibrated>(
      m, "Calibration", "The floor's constants and the pitch, fitted to drops.",
      [](const Calibrated& x, tools::Run& run) { return report(x.fitted, x.validation, tools::Doubt::kReport, run); });
  property(c, "scene", "The given scene with the fitted constants.", [](auto& x) { return x.fitted.result.scene; });
  bind_file(c, "the scene's file, with the constants' verdicts",
            [](const Calibrated& x) { return to_toml(x.fitted.result.scene, ""); });
}

}  // namespace

void bind_calibrate(py::module_& m) {
  bind_logs(m), bind_drop(m), bind_drop_fit(m), bind_paper_calibration(m);
  m.def(
      "calibrate",
      [](const Scene& scene, const Actuator& actuator, const std::vector<PlayedDrop>& drops,
         const std::optional<std::vector<std::string>>& free, const std::vector<std::string>& nuisance,
         const Priors& priors, const Bounds& lower, const Bounds& upper, double accuracy, std::uint64_t seed,
         const std::vector<PlayedDrop>& validate, const std::vector<std::string>& profile, const Bounds& errors) {
        tools::CalibrationOptions o;
        o.terms = chosen_terms(std::move(o.terms), free, nuisance, priors, lower, upper);
        o.accuracy = accuracy, o.seed = seed, o.profiles = profile;
        o.errors.assign(errors.begin(), errors.end());
        require_gains(actuator);
        const auto fit = [&](auto& logged, auto& options) {
          Calibration c = tools::calibrate(scene, actuator.sea, logged, options);
          c.scene.floor_source = "calibrated from drop logs by ukemi";
          return c;
        };
        return calibrated_drops<tools::CalibratedDrops>(scene, drops, validate, std::move(o), fit,
                                                        [&](auto& fitted, auto& others, auto& options) {
                                                          return tools::validate(fitted, actuator.sea, others, options);
                                                        });
      },
      py::arg("scene"), py::arg("actuator"), py::arg("drops"), py::arg("free") = py::none(),
      py::arg("nuisance") = std::vector<std::string>{}, py::arg("priors") = Priors{}, py::arg("lower") = Bounds{},
      py::arg("upper") = Bounds{}, py::arg("accuracy") = 1e-9, py::arg("seed") = 1,
      py::arg("validate") = std::vector<PlayedDrop>{}, py::arg("profile") = std::vector<std::string>{},
      py::arg("errors") = Bounds{},
      "Fits the floor's constants and the pitch to logs of drops, as `ukemi calibrate`. free: of stiffness, "
      "damping_normal, damping_tangential, pitch (None: all); priors: name -> (value, standard deviation); lower, "
      "upper: name -> bound, each in the term's unit (pitch [rad]); validate: drops that are not fitted; profile: "
      "constants whose likelihood profile is made; errors: standard deviations of constants that are not fitted.");
}

}  // namespace ukemi::python

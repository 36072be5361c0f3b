// Python bindings of drop logs of robots of links and the calibration of their floor.
#include <fmt/format.h>

#include <variant>

#include "landing/drops/drop_log.hpp"
#include "tools/program/arguments.hpp"
#include "tools/python/body.hpp"
#include "tools/python/floor_fit.hpp"
#include "tools/report/calibrate.hpp"
#include "tools/report/results.hpp"

namespace ukemi::python {

using namespace landing;
using tools::BodyCalibratedDrops, tools::BodyCalibration, tools::BodyCalibrationOptions, tools::BodyLoggedDrop,
    tools::DropResult, tools::TriedLaw;

namespace {

/// A log with its output channels.
struct BodyDropLog {
  DropLog log;
  std::vector<DropChannel> channels;
};

BodyDropLog body_log_of(const BodyScene& scene, const Numbers& t, const std::map<std::string, Numbers>& outputs,
                        const std::string& name) {
  BodyDropLog out{{}, body_channels(scene.robot)};
  out.log.file = name, out.log.t = drop_times(t, name), out.log.output.resize(out.channels.size());
  for (const auto& [output, values] : outputs) {
    const auto at = std::find_if(out.channels.begin(), out.channels.end(),
                                 [&output = output](const DropChannel& c) { return c.name == output; });
    if (at == out.channels.end())
      throw InputError(fmt::format("{}: {}: {} is needed", name, quoted(output), names_of(out.channels)));
    out.log.output[std::size_t(at - out.channels.begin())] = drop_output(output, values, out.log.t.size(), name);
  }
  return out;
}

void bind_body_log(py::module_& m) {
  py::class_<BodyDropLog> c(m, "RobotDropLog", "What was measured of a robot of links in one drop.");
  c.def(py::init(&body_log_of),
        "Times t from release [s]; outputs by name, as \"acc\" [m/s^2], \"x_thigh\" [m], \"phi_knee\" [rad]: arrays as "
        "long as t, NaN where not measured.",
        py::arg("scene"), py::arg("t"), py::arg("outputs"), py::arg("name") = "drop");
  property(c, "name", "Its file, or the name that it was given.", [](auto& d) { return d.log.file; });
  column_property(
      c, "t", "Times from release [s].", [](auto& d) -> auto& { return d.log.t; });
  c.def_property_readonly(
       "outputs",
       [](const py::object& self) {
         const auto& d = self.cast<const BodyDropLog&>();
         py::dict out;
         for (std::size_t o = 0; o < d.channels.size(); ++o)
           if (!d.log.output[o].empty()) out[py::str(d.channels[o].name)] = view(d.log.output[o], self);
         return out;
       },
       "What was measured, by its name [m/s^2, m or rad].")
      .def("__repr__", [](const BodyDropLog& d) {
        return fmt::format("<ukemi.RobotDropLog {}: {} rows>", d.log.file, d.log.t.size());
      });
  bind_value(c);
  m.def(
      "read_drop",
      [](const Path& path, const BodyScene& scene) {
        const std::vector<DropChannel> channels = body_channels(scene.robot);
        return BodyDropLog{read_drop(path, channels), channels};
      },
      py::arg("path"), py::arg("scene"), "The same of a robot of links.");
}

/// A log with the played motions; an absent number is the scene's.
struct PlayedBodyDrop {
  BodyDropLog log;
  JointMotions motions;
  std::optional<double> height, forward_speed;

  BodyLoggedDrop logged_drop(const BodyScene& scene) const {
    const std::vector<DropChannel> channels = body_channels(scene.robot);
    if (!std::equal(channels.begin(), channels.end(), log.channels.begin(), log.channels.end(),
                    [](const DropChannel& a, const DropChannel& b) { return a.name == b.name; }))
      throw InputError(log.log.file + ": a drop of another robot");
    tools::check_drop_arguments(scene.robot, height ? "height" : nullptr, forward_speed ? "forward_speed" : nullptr);
    return {log.log, motions_of(scene, motions), dropped(scene.drop, {height, forward_speed})};
  }
};

void bind_body_drop(py::module_& m) {
  py::class_<PlayedBodyDrop> c(m, "RobotDrop", "A log with the motions that were played, and how it was thrown.");
  c.def(py::init([](const BodyDropLog& log, const JointMotions& motions, std::optional<double> height,
                    std::optional<double> forward_speed) {
          return PlayedBodyDrop{log, motions, checked("height", height, Range::non_negative()),
                                checked("forward_speed", forward_speed, Range::any())};
        }),
        "motions: by joint, one that is not named is held as the scene says; height [m] and forward_speed [m/s]; None: "
        "the scene's.",
        py::arg("log"), py::arg("motions") = JointMotions{}, py::arg("height") = py::none(),
        py::arg("forward_speed") = py::none())
      .def_readonly("log", &PlayedBodyDrop::log, "What was measured.")
      .def_readonly("motions", &PlayedBodyDrop::motions, "What was played, by joint.")
      .def_readonly("height", &PlayedBodyDrop::height, "Of the drop [m]; None: the scene's.")
      .def_readonly("forward_speed", &PlayedBodyDrop::forward_speed, "At release [m/s]; None: the scene's.");
  bind_value(c);
}

using BodyCalibrated = CalibratedOf<BodyCalibratedDrops>;

enum class Law { kScene, kAsked, kOnly };
Law law_of(const std::string& text) {
  return tools::choice<Law>("law", text, {{"scene", Law::kScene}, {"asked", Law::kAsked}, {"only", Law::kOnly}});
}

BodyCalibrated calibrated(const BodyScene& scene, const std::vector<PlayedBodyDrop>& played,
                          const std::vector<PlayedBodyDrop>& held_out, Law law, BodyCalibrationOptions options) {
  if (law == Law::kOnly) options.rivals = BodyCalibrationOptions::Rivals::kNone;
  const auto fit = [&](auto& drops, auto& o) {
    BodyCalibration c = tools::calibrate(scene, drops, o);
    if (law == Law::kAsked) adopt_best_law(c, drops, o);
    return c;
  };
  return calibrated_drops<BodyCalibratedDrops>(
      scene, played, held_out, std::move(options), fit,
      [](auto& fitted, auto& others, auto& o) { return tools::validate(fitted, others, o); });
}

/// A tried contact law as a dict.
py::dict dict_of(const TriedLaw& t) {
  py::dict out;
  out["law"] = words(t.law), out["converged"] = t.converged, out["rms"] = t.rms, out["bic"] = t.bic;
  out["held_out"] = t.held_out, out["rejected"] = t.rejected;
  return out;
}

void bind_laws(py::class_<BodyCalibrated>& c) {
  property(c, "laws",
           "The laws that were tried, the scene's first: a dict of law, converged, rms (in the logs' noise [1]), bic "
           "(less that of the scene's), held_out (rms of drops left out) and rejected.",
           [](auto& x) {
             py::list out;
             for (const TriedLaw& t : x.fitted.result.laws) out.append(dict_of(t));
             return out;
           });
  property(c, "asked", "The law that the drops support best; None where nothing could be followed.", [](auto& x) {
    const BodyCalibration& found = x.fitted.result;
    return found.laws.empty() ? std::nullopt : std::optional(words(found.laws[found.best_law].law));
  });
  property(c, "law_rejected",
           "Whether the drops speak against the law of `scene`: its residuals do, or another is better beyond doubt.",
           [](auto& x) { return x.fitted.result.law_rejected(); });
}

void bind_body_calibration(py::module_& m) {
  auto c = bind_calibration<BodyCalibrated>(m, "RobotCalibration", "The floor of a robot of links, fitted to drops.",
                                            [](const BodyCalibrated& x, tools::Run& run) {
                                              return report(x.file, x.fitted, x.validation, tools::Doubt::kReport, run);
                                            });
  bind_laws(c);
  property(c, "scene", "The given scene with what was fitted.", [](auto& x) { return x.fitted.result.scene; });
}

}  // namespace

void bind_body_calibrate(py::module_& m) {
  bind_body_log(m), bind_body_drop(m), bind_body_calibration(m);
  m.def(
      "calibrate",
      [](const std::variant<BodyScene, Path>& given, const std::vector<PlayedBodyDrop>& drops,
         const std::optional<std::vector<std::string>>& free, const std::vector<std::string>& nuisance,
         const Priors& priors, const Bounds& lower, const Bounds& upper, double accuracy, std::uint64_t seed,
         const std::vector<PlayedBodyDrop>& validate, const std::string& law, const std::vector<std::string>& profile,
         const Bounds& errors, int threads) {
        const Path* const file = std::get_if<Path>(&given);
        const BodyScene scene = file ? read_body_scene(*file) : std::get<BodyScene>(given);
        BodyCalibrationOptions o;
        o.terms = chosen_terms(tools::drop_choice(scene), free, nuisance, priors, lower, upper);
        o.accuracy = accuracy, o.seed = seed, o.threads = threads, o.profiles = profile;
        o.errors.assign(errors.begin(), errors.end());
        BodyCalibrated out = calibrated(scene, drops, validate, law_of(law), std::move(o));
        if (file) out.file = *file;
        return out;
      },
      py::arg("scene"), py::arg("drops"), py::arg("free") = py::none(),
      py::arg("nuisance") = std::vector<std::string>{}, py::arg("priors") = Priors{}, py::arg("lower") = Bounds{},
      py::arg("upper") = Bounds{}, py::arg("accuracy") = 1e-9, py::arg("seed") = 1,
      py::arg("validate") = std::vector<PlayedBodyDrop>{}, py::arg("law") = "scene",
      py::arg("profile") = std::vector<std::string>{}, py::arg("errors") = Bounds{}, py::arg("threads") = 0,
      "The same of a robot of links. scene: its file or a RobotScene; of a file the report holds scene.toml with the "
      "fitted constants. free: None: all of the scene's contact laws, CONTACT.NAME of a contact that has its own; law: "
      "\"scene\" (others are tried), \"asked\" (the one that the drops ask for is fitted) or \"only\" (none is "
      "tried).");
}

}  // namespace ukemi::python

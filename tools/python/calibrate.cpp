// Python bindings of drop logs and the calibration of the floor.
#include <fmt/format.h>

#include <cmath>
#include <variant>

#include "common/actuator.hpp"
#include "common/csv.hpp"
#include "landing/drops/drop_log.hpp"
#include "landing/model/scene_file.hpp"
#include "tools/program/arguments.hpp"
#include "tools/python/arguments.hpp"
#include "tools/report/calibrate.hpp"
#include "tools/report/estimates.hpp"
#include "tools/report/results.hpp"
#include "tools/study/calibration.hpp"
#include "tools/study/floor_fit.hpp"

namespace ukemi::python {

using namespace landing;
using tools::BodyCalibratedDrops, tools::BodyCalibration, tools::BodyCalibrationOptions, tools::BodyLoggedDrop,
    tools::Calibration, tools::DropResult, tools::TriedLaw;

std::map<std::string, double> rms_by_output(const tools::FloorFit& fit) {
  std::map<std::string, double> out;
  for (std::size_t o = 0; o < fit.channels.size(); ++o)
    if (std::isfinite(fit.noise[o])) out[fit.channels[o].name] = fit.rms[o];
  return out;
}

/// A calibration, `Drops`: drops and their fit, and validation drops that were not fitted.
template <class Drops>
struct CalibratedOf {
  Drops fitted;
  std::optional<Drops> validation = {};
  std::string file = {};  ///< of the scene of a robot of links; empty: none
  std::uint64_t seed = 1;
};

/// A log with what was played; an absent number is the scene's.
template <class Log, class Play>
struct PlayedLog {
  Log log;
  Play play;
  std::optional<double> height, forward_speed;
};

namespace {

/// Times of a log from release [s]. Throws InputError, which names the log `name`.
std::vector<double> drop_times(const Numbers& t, const std::string& name) {
  std::vector<double> out = column("t", t);
  require_times("t", out);
  if (out.front() < 0)
    throw InputError(fmt::format("{}: t[0]: {}: times from the release on are needed", name, shortest(out.front())));
  return out;
}

/// A measured output, NaN where it was not measured; empty without values. Throws InputError, which names `name`.
std::vector<double> drop_output(const std::string& output, const std::optional<Numbers>& values, std::size_t rows,
                                const std::string& name) {
  std::vector<double> out = column(output, values, rows);
  for (std::size_t i = 0; i < out.size(); ++i)
    if (std::isinf(out[i]))
      throw InputError(
          fmt::format("{}: {}[{}]: a number, or NaN where it was not measured, is needed", name, output, i));
  return out;
}

/// Binds it; `how`: of the constructor; `play`: the argument of what was played, `played`: what it is.
template <class Log, class Play, class Arg>
void bind_played_log(py::module_& m, const char* name, const char* words, const char* how, const Arg& play,
                     const char* played) {
  using Drop = PlayedLog<Log, Play>;
  Value<Drop> c(m, name, words);
  c.def(py::init(
            [](const Log& log, const Play& what, std::optional<double> height, std::optional<double> forward_speed) {
              return Drop{log, what, checked("height", height, Range::non_negative()),
                          checked("forward_speed", forward_speed, Range::any())};
            }),
        how, py::arg("log"), play, py::arg("height") = py::none(), py::arg("forward_speed") = py::none())
      .def_readonly("log", &Drop::log, "What was measured.")
      .def_readonly(play.name, &Drop::play, played)
      .def_readonly("height", &Drop::height, "Of the drop [m]; None: the scene's.")
      .def_readonly("forward_speed", &Drop::forward_speed, "At release [m/s]; None: the scene's.");
}

template <class Played>
struct CalibrateArguments : Arguments {
  std::vector<Played> validate = {};
  std::string law = "scene";
};
/// Each drop that was played as the scene has it.
template <class Played, class Scene>
auto logged_drops(const std::vector<Played>& played, const Scene& scene) {
  std::vector<decltype(logged_drop(played[0], scene))> out;
  for (const Played& d : played) out.push_back(logged_drop(d, scene));
  return out;
}

/// fit(drops, options) and, for those that are held out, validate(fitted scene, drops, options).
template <class Drops, class Played, class Scene, class Options, class Fit, class Validate>
CalibratedOf<Drops> calibrated_drops(const Scene& scene, const std::vector<Played>& played,
                                     const std::vector<Played>& held_out, Options options, Fit fit, Validate validate) {
  options.validate();
  CalibratedOf<Drops> out{.fitted = {logged_drops(played, scene), {}}, .seed = options.seed};
  const auto others = logged_drops(held_out, scene);
  check_drops(scene, out.fitted.drops);
  if (!others.empty()) check_drops(scene, others);
  return long_call([&](const std::function<bool()>& stop) {
    options.monitor.stop = stop;
    out.fitted.result = fit(out.fitted.drops, options);
    if (!others.empty() && !stop()) out.validation = {others, validate(out.fitted.result.scene, others, options)};
    return out;
  });
}

/// Binds a calibration; report(calibration, run): the program's own report.
template <class T, class Report>
py::class_<T> bind_calibration(py::module_& m, const char* name, const char* words, Report report) {
  Value<T> c(m, name, words);
  const auto fit = [](auto& x) -> auto& { return x.fitted.result; };
  bind_estimates(c, fit);
  property(c, "model_rejected", "Whether the residuals speak against the floor.",
           [fit](auto& x) { return fit(x).tests.model_rejected(); });
  property(c, "drops", "Each drop beside its log.", [fit](auto& x) { return fit(x).drops; });
  property(c, "rms", "Residual of each output that was measured, by its name [m/s^2, m or rad].",
           [fit](auto& x) { return rms_by_output(fit(x)); });
  bind_profiles(c, [fit](auto& x) { return fit(x).profiles; });
  property(c, "validation", "The same of drops that were not fitted.",
           [](auto& x) { return x.validation ? x.validation->result.drops : std::vector<tools::DropResult>{}; });
  c.def("__repr__", [name, fit](const T& x) {
    return fmt::format("<ukemi.{} of {} drops, cost {:.4g}{}>", name, x.fitted.drops.size(), fit(x).cost,
                       fit(x).trusted() ? ", trusted" : "");
  });
  bind_report(
      c, tools::kCalibrateOutputs, [](auto& x) { return x.seed; }, report);
  return c;
}

/// A log with its output channels.
struct BodyDropLog {
  DropLog log;
  std::vector<DropChannel> channels;
};

}  // namespace

using PlayedBodyDrop = PlayedLog<BodyDropLog, JointMotions>;
/// The drop as the scene has it; not in the unnamed namespace, where logged_drops would not find it.
static BodyLoggedDrop logged_drop(const PlayedBodyDrop& d, const BodyScene& scene) {
  const std::vector<DropChannel> channels = body_channels(scene.robot);
  if (!std::equal(channels.begin(), channels.end(), d.log.channels.begin(), d.log.channels.end(),
                  [](const DropChannel& a, const DropChannel& b) { return a.name == b.name; }))
    throw InputError(d.log.log.file + ": a drop of another robot");
  tools::check_drop_arguments(scene.robot, d.height ? "height" : nullptr, d.forward_speed ? "forward_speed" : nullptr);
  return {d.log.log, motions_of(scene, d.play), dropped(scene.drop, {d.height, d.forward_speed})};
}
using PlayedDrop = PlayedLog<DropLog, Motion>;
static tools::LoggedDrop logged_drop(const PlayedDrop& d, const Scene& scene) {
  return {d.log, d.play, dropped(scene.drop, {d.height, d.forward_speed})};
}

namespace {

DropLog log_of(const Numbers& t, const std::array<std::optional<Numbers>, kOutputs>& outputs, const std::string& name) {
  DropLog out;
  out.file = name, out.t = drop_times(t, name);
  for (std::size_t o = 0; o < kOutputs; ++o)
    out.output[o] = drop_output(thigh_channels()[o].name, outputs[o], out.t.size(), name);
  return out;
}

void bind_logs(py::module_& m) {
  Value<DropLog> c(m, "DropLog", "What was measured of the thigh in one drop.");
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
  bind_reader(m, "read_drop", "Reads a log of a drop (CSV).", [](const Path& path) { return read_drop(path); });
}

using Calibrated = CalibratedOf<tools::CalibratedDrops>;

void bind_drop_fit(py::module_& m) {
  Value<DropResult> c(m, "DropFit", "One drop, simulated beside its log.");
  c.def_readonly("name", &DropResult::file, "Of the log.")
      .def_readonly("peak_measured", &DropResult::peak_measured,
                    "Largest |ddr_0| of the log [m/s^2]; NaN: not measured.")
      .def_readonly("peak_simulated", &DropResult::peak_simulated, "Largest |ddr_0| at the log's samples [m/s^2].");
}

void bind_paper_calibration(py::module_& m) {
  auto c = bind_calibration<Calibrated>(
      m, "Calibration", "The floor's constants and the pitch, fitted to drops.",
      [](const Calibrated& x, tools::Run& run) { return report(x.fitted, x.validation, tools::Doubt::kReport, run); });
  property(c, "scene", "The given scene with the fitted constants.", [](auto& x) { return x.fitted.result.scene; });
  bind_file(c, "the scene's file, with the constants' verdicts",
            [](const Calibrated& x) { return to_toml(x.fitted.result.scene, ""); });
}

void bind_paper_calibrate(py::module_& m) {
  bind_logs(m);
  bind_played_log<DropLog, Motion>(m, "Drop", "A log with the motion that was played, and how the robot was thrown.",
                                   "height [m] and forward_speed [m/s]; None: the scene's.", py::arg("motion"),
                                   "What was played.");
  bind_drop_fit(m), bind_paper_calibration(m);
  define(
      m, "calibrate",
      [](const CalibrateArguments<PlayedDrop>& a, const Scene& scene, const Actuator& actuator,
         const std::vector<PlayedDrop>& drops) {
        tools::CalibrationOptions o;
        o = fit_options(o, o.terms, a);
        require_gains(actuator);
        const auto fit = [&](auto& logged, auto& options) {
          Calibration c = tools::calibrate(scene, actuator.sea, logged, options);
          c.scene.floor_source = "calibrated from drop logs by ukemi";
          return c;
        };
        return calibrated_drops<tools::CalibratedDrops>(scene, drops, a.validate, std::move(o), fit,
                                                        [&](auto& fitted, auto& others, auto& options) {
                                                          return tools::validate(fitted, actuator.sea, others, options);
                                                        });
      },
      py::arg("scene"), py::arg("actuator"), py::arg("drops"), kFree, kNuisance, kPriors, kLower, kUpper, kAccuracy,
      kSeed, Argument{"validate", &CalibrateArguments<PlayedDrop>::validate}, kProfile, kErrors,
      "Fits the floor's constants and the pitch to logs of drops, as `ukemi calibrate`. free: of stiffness, "
      "damping_normal, damping_tangential, pitch (None: all); priors: name -> (value, standard deviation); lower, "
      "upper: name -> bound, each in the term's unit (pitch [rad]); validate: drops that are not fitted; profile: "
      "constants whose likelihood profile is made; errors: standard deviations of constants that are not fitted.");
}

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
  Value<BodyDropLog> c(m, "RobotDropLog", "What was measured of a robot of links in one drop.");
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
      "What was measured, by its name [m/s^2, m or rad].");
  c.repr([](auto& d) { return fmt::format(" {}: {} rows", d.log.file, d.log.t.size()); });
  m.def(
      "read_drop",
      [](const Path& path, const BodyScene& scene) {
        const std::vector<DropChannel> channels = body_channels(scene.robot);
        return BodyDropLog{read_drop(path, channels), channels};
      },
      py::arg("path"), py::arg("scene"), "The same of a robot of links.");
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
           [](auto& x) { return list_of(x.fitted.result.laws, [](const TriedLaw& t) { return dict_of(t); }); });
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

void bind_body_calibrate(py::module_& m) {
  bind_body_log(m);
  bind_played_log<BodyDropLog, JointMotions>(
      m, "RobotDrop", "A log with the motions that were played, and how it was thrown.",
      "motions: by joint, one that is not named is held as the scene says; height [m] and forward_speed [m/s]; None: "
      "the scene's.",
      py::arg("motions") = JointMotions{}, "What was played, by joint.");
  bind_body_calibration(m);
  using Calibrating = CalibrateArguments<PlayedBodyDrop>;
  define(
      m, "calibrate",
      [](const Calibrating& a, const std::variant<BodyScene, Path>& given, const std::vector<PlayedBodyDrop>& drops) {
        const Path* const file = std::get_if<Path>(&given);
        const BodyScene scene = file ? read_body_scene(*file) : std::get<BodyScene>(given);
        BodyCalibrationOptions o = fit_options(BodyCalibrationOptions(), tools::drop_choice(scene), a);
        o.threads = a.threads;
        BodyCalibrated out = calibrated(scene, drops, a.validate, law_of(a.law), std::move(o));
        if (file) out.file = *file;
        return out;
      },
      py::arg("scene"), py::arg("drops"), kFree, kNuisance, kPriors, kLower, kUpper, kAccuracy, kSeed,
      Argument{"validate", &Calibrating::validate}, Argument{"law", &Calibrating::law}, kProfile, kErrors, kThreads,
      "The same of a robot of links. scene: its file or a RobotScene; of a file the report holds scene.toml with the "
      "fitted constants. free: None: all of the scene's contact laws, CONTACT.NAME of a contact that has its own; law: "
      "\"scene\" (others are tried), \"asked\" (the one that the drops ask for is fitted) or \"only\" (none is "
      "tried).");
}

}  // namespace

void bind_calibrate(py::module_& m) { bind_paper_calibrate(m), bind_body_calibrate(m); }

}  // namespace ukemi::python

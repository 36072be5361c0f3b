// Shared by the bindings of drop logs and fits to them, for both kinds of robot.
#pragma once

#include "tools/python/value.hpp"
#include "tools/report/estimates.hpp"
#include "tools/report/results.hpp"
#include "tools/study/floor_fit.hpp"

namespace ukemi::python {

/// Times of a log from release [s]. Throws InputError, which names the log `name`.
std::vector<double> drop_times(const Numbers& t, const std::string& name);
/// A measured output, NaN where it was not measured; empty without values. Throws InputError, which names `name`.
std::vector<double> drop_output(const std::string& output, const std::optional<Numbers>& values, std::size_t rows,
                                const std::string& name);

/// Residuals of the outputs that were measured, by name.
std::map<std::string, double> rms_by_output(const tools::FloorFit& fit);

/// A calibration, `Drops`: drops and their fit, and validation drops that were not fitted.
template <class Drops>
struct CalibratedOf {
  Drops fitted;
  std::optional<Drops> validation = {};
  std::string file = {};  ///< of the scene of a robot of links; empty: none
  std::uint64_t seed = 1;
};

/// Each drop that was played as the scene has it.
template <class Played, class Scene>
auto logged_drops(const std::vector<Played>& played, const Scene& scene) {
  std::vector<decltype(played[0].logged_drop(scene))> out;
  for (const Played& d : played) out.push_back(d.logged_drop(scene));
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
  py::class_<T> c(m, name, words);
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
  bind_value(c);
  bind_report(
      c, tools::kCalibrateOutputs, [](auto& x) { return x.seed; }, report);
  return c;
}

}  // namespace ukemi::python

// Python bindings of risk: peaks over drops that scatter.
#include <fmt/format.h>

#include "landing/scatter/drop_file.hpp"
#include "tools/python/search.hpp"
#include "tools/report/results.hpp"
#include "tools/report/risk.hpp"
#include "tools/report/scatter.hpp"

namespace ukemi::python {

using namespace landing;

namespace {

/// A study and the seed of its drops.
struct RiskResult {
  tools::RiskStudy study;
  std::uint64_t seed = 1;
};

void bind_distribution(py::module_& m) {
  py::class_<Estimated> estimated(m, "Estimated",
                                  "A value with the standard error that it has from the number of drops.");
  estimated.def_readonly("value", &Estimated::value, "The value [m/s^2].")
      .def_readonly("standard_error", &Estimated::standard_error, "Its standard error [m/s^2].")
      .def("__float__", [](const Estimated& e) { return e.value; })
      .def("__repr__", [](const Estimated& e) {
        return fmt::format("<ukemi.Estimated {:.6g} +- {:.2g}>", e.value, e.standard_error);
      });
  bind_value(estimated);
  py::class_<Distribution> c(m, "Distribution", "Peaks over scattered drops.");
  c.def_readonly("mean", &Distribution::mean, "Mean peak [m/s^2].")
      .def_readonly("cvar90", &Distribution::cvar90, "Mean of the worst tenth [m/s^2].")
      .def_readonly("median", &Distribution::median, "Half of the peaks are below [m/s^2].")
      .def_readonly("q90", &Distribution::q90, "90 % of the peaks are below [m/s^2].")
      .def_readonly("q99", &Distribution::q99, "99 % of the peaks are below [m/s^2].")
      .def_readonly("max", &Distribution::max, "The largest peak [m/s^2].")
      .def_readonly("samples", &Distribution::samples, "Drops.");
  c.def("__repr__",
        [](const Distribution& d) { return "<ukemi.Distribution: " + tools::distribution_words(d) + " m/s^2>"; });
  bind_value(c);
}

}  // namespace

void check_measured(const std::optional<std::string>& scatter, double inflate) {
  if (scatter || inflate != 1)
    throw InputError(std::string(scatter ? "scatter" : "inflate") +
                     ": beside drops it has no effect: the drops come as they were measured");
}
std::vector<ScatteredDrop> measured_drops(const std::optional<Path>& file, const Scene& scene, const Actuator& actuator,
                                          const std::optional<std::string>& scatter, double inflate) {
  if (!file) return {};
  check_measured(scatter, inflate);
  return read_drops(*file, scene, actuator.sea);
}

void bind_risk(py::module_& m) {
  bind_distribution(m);
  py::class_<RiskResult> c(m, "Risk", "The peaks of a motion over drops that scatter, and what scatters them.");
  bind_peak_risk(
      c, [](auto& r) -> auto& { return r.study.risk; });
  c.def("__repr__", [](const RiskResult& r) {
    return "<ukemi.Risk: " + tools::distribution_words(r.study.risk.peaks) + " m/s^2>";
  });
  bind_value(c);
  bind_report(c, tools::kRiskOutputs, &RiskResult::seed, [](auto& r, tools::Run& run) { return report(r.study, run); });
  m.def(
      "risk",
      [](const Scene& scene, const Actuator& actuator, const Motion& motion, const std::optional<std::string>& scatter,
         double inflate, bool inexact, long samples, const std::vector<std::string>& forbid, std::uint64_t seed,
         int threads, const std::optional<Path>& drops) {
        require_gains(actuator);
        RiskOptions options{.samples = samples, .forbidden = points_of(forbid), .seed = seed, .threads = threads};
        options.validate();
        tools::RiskStudy study{.scene = scene, .actuator = actuator, .motion = motion};
        study.scattering = {.inflate = inflation(inflate), .inexact = inexact};
        options.measured = measured_drops(drops, scene, actuator, scatter, inflate);
        if (drops && inexact) throw InputError("inexact: beside drops it has no effect");
        if (!drops) study.scatter = scatter_for(parsed_scatter(scatter), scene);
        study.assumed = !drops && !scatter && !scene.scatter;
        const DropModel model(scene, study.scatter.value_or(Scatter{}), actuator, study.scattering);
        study.risk = long_call([&](const std::function<bool()>& stop) {
          options.monitor.stop = stop;
          return risk(model, actuator, motion, options);
        });
        return RiskResult{std::move(study), seed};
      },
      py::arg("scene"), py::arg("actuator"), py::arg("motion"), py::arg("scatter") = py::none(),
      py::arg("inflate") = 1.0, py::arg("inexact") = false, py::arg("samples") = RiskOptions().samples,
      py::arg("forbid") = std::vector<std::string>{}, py::arg("seed") = 1, py::arg("threads") = 0,
      py::arg("drops") = py::none(),
      "Plays a motion over drops that scatter, as `ukemi risk`. scatter: \"pitch_deg=1,height=0.01\", None: the "
      "scene's, else 1 deg, 1 cm, 3 cm/s; inflate: factor of the standard errors of the actuator's constants [1]; "
      "drops: a CSV file of measured ones, in place of drawn ones.");
}

}  // namespace ukemi::python

// Python bindings of risk: peaks over drops that scatter.
#include <fmt/format.h>

#include "landing/plan/body_drop_file.hpp"
#include "landing/scatter/drop_file.hpp"
#include "tools/python/arguments.hpp"
#include "tools/report/body.hpp"
#include "tools/report/results.hpp"
#include "tools/report/risk.hpp"
#include "tools/report/scatter.hpp"

namespace ukemi::python {

using namespace landing;

static void check_measured(const Arguments& a) {
  if (a.scatter || a.inflate != 1)
    throw InputError(std::string(a.scatter ? "scatter" : "inflate") +
                     ": beside drops it has no effect: the drops come as they were measured");
}
std::vector<ScatteredDrop> measured_drops(const Arguments& a, const Scene& scene, const Actuator& actuator) {
  if (!a.drops) return {};
  check_measured(a);
  return read_drops(*a.drops, scene, actuator.sea);
}
std::shared_ptr<const std::vector<BodyDrop>> measured_drops(const Arguments& a, const BodyScene& scene) {
  if (!a.drops) return nullptr;
  check_measured(a);
  return std::make_shared<const std::vector<BodyDrop>>(read_drops(*a.drops, scene));
}

namespace {

using RiskResult = Seeded<tools::RiskStudy>;
struct BodyRiskResult {
  BodyScene scene;
  BodyMotion motion;
  BodyRisk risk;
  BodyRiskOptions options;
};

/// Binds what all risks share; of(result): the risk.
template <class T, class Of, class... Options>
void bind_peak_risk(py::class_<T, Options...>& c, const char* name, Of of) {
  using landing::PeakRisk;
  property(c, "peaks", "Of the motion [m/s^2].", [of](auto& x) { return of(x).peaks; });
  property(c, "held", "Of what is held over the same drops [m/s^2].", [of](auto& x) { return of(x).held; });
  property(c, "failed", "Landings that could not be followed to the floor.", [of](auto& x) { return of(x).failed; });
  property(c, "joint_lost", "Of the others, those whose drive lost the joint.", [of](auto& x) { return of(x).lost; });
  property(c, "from_floor", "Drops that would begin below the floor: they begin on it.",
           [of](auto& x) { return of(x).from_floor; });
  property(c, "share", "The share of drops that keep every limit [1].", [of](auto& x) { return of(x).kept(); });
  property(c, "histogram", "Drops with a peak in each bin, and the bins' edges [m/s^2], as numpy.histogram gives them.",
           [of](auto& x) {
             std::vector<double> edges, drops;
             for (const landing::PeakBin& b : of(x).histogram)
               edges.push_back(b.lower), drops.push_back(double(b.drops));
             if (!edges.empty()) edges.push_back(of(x).histogram.back().upper);
             return std::pair(py::array_t<double>(py::ssize_t(drops.size()), drops.data()),
                              py::array_t<double>(py::ssize_t(edges.size()), edges.data()));
           });
  property(c, "uncertainties", "Sobol's indices of each group of numbers that scatter: first order and total [1].",
           [of](auto& x) {
             std::map<std::string, std::pair<double, double>> out;
             for (const PeakRisk::Uncertainty& u : of(x).uncertainties)
               out[u.name] = {u.index.first.value, u.index.total.value};
             return out;
           });
  c.def("__repr__", [of, name](const T& x) {
    return fmt::format("<ukemi.{}: {} m/s^2>", name, tools::distribution_words(of(x).peaks));
  });
}

void bind_distribution(py::module_& m) {
  Value<Estimated> estimated(m, "Estimated", "A value with the standard error that it has from the number of drops.");
  estimated.def_readonly("value", &Estimated::value, "The value [m/s^2].")
      .def_readonly("standard_error", &Estimated::standard_error, "Its standard error [m/s^2].")
      .def("__float__", [](const Estimated& e) { return e.value; });
  estimated.repr([](auto& e) { return fmt::format(" {:.6g} +- {:.2g}", e.value, e.standard_error); });
  Value<Distribution> c(m, "Distribution", "Peaks over scattered drops.");
  c.def_readonly("mean", &Distribution::mean, "Mean peak [m/s^2].")
      .def_readonly("cvar90", &Distribution::cvar90, "Mean of the worst tenth [m/s^2].")
      .def_readonly("median", &Distribution::median, "Half of the peaks are below [m/s^2].")
      .def_readonly("q90", &Distribution::q90, "90 % of the peaks are below [m/s^2].")
      .def_readonly("q99", &Distribution::q99, "99 % of the peaks are below [m/s^2].")
      .def_readonly("max", &Distribution::max, "The largest peak [m/s^2].")
      .def_readonly("samples", &Distribution::samples, "Drops.");
  c.def("__repr__",
        [](const Distribution& d) { return "<ukemi.Distribution: " + tools::distribution_words(d) + " m/s^2>"; });
}

void bind_paper_risk(py::module_& m) {
  Value<RiskResult> c(m, "Risk", "The peaks of a motion over drops that scatter, and what scatters them.");
  bind_peak_risk(
      c, "Risk", [](auto& r) -> auto& { return r.result.risk; });
  bind_report(c, tools::kRiskOutputs);
  define(
      m, "risk",
      [](const Arguments& a, const Scene& scene, const Actuator& actuator, const Motion& motion) {
        require_gains(actuator);
        RiskOptions options{
            .samples = a.samples, .forbidden = points_of(a.forbid), .seed = a.seed, .threads = a.threads};
        options.validate();
        tools::RiskStudy study{.scene = scene, .actuator = actuator, .motion = motion};
        study.scattering = {.inflate = inflation(a.inflate), .inexact = a.inexact};
        options.measured = measured_drops(a, scene, actuator);
        if (a.drops && a.inexact) throw InputError("inexact: beside drops it has no effect");
        if (!a.drops) study.scatter = scatter_for(parsed_scatter(a.scatter), scene);
        study.assumed = !a.drops && !a.scatter && !scene.scatter;
        const DropModel model(scene, study.scatter.value_or(Scatter{}), actuator, study.scattering);
        study.risk = monitored([&] { return risk(model, actuator, motion, options); }, options.monitor);
        return RiskResult{std::move(study), a.seed};
      },
      py::arg("scene"), py::arg("actuator"), py::arg("motion"), kScatter, kInflate, kInexact,
      kSamples.with(RiskOptions().samples), kForbid, kSeed, kThreads, kDrops,
      "Plays a motion over drops that scatter, as `ukemi risk`. scatter: \"pitch_deg=1,height=0.01\", None: the "
      "scene's, else 1 deg, 1 cm, 3 cm/s; inflate: factor of the standard errors of the actuator's constants [1]; "
      "drops: a CSV file of measured ones, in place of drawn ones.");
}

/// The loads by name, each with the number and the share of drops in which it exceeds its rating.
py::dict loads_of_risk(const BodyRiskResult& r) {
  py::dict out = loads_of_scene(r.scene);
  for (const RiskEvent& e : r.risk.events) {
    if (e.load < 0) continue;
    py::object load = out[r.scene.loads[std::size_t(e.load)].name.c_str()];
    load["drops"] = e.drops, load["share"] = double(e.drops) / double(r.risk.peaks.samples);
  }
  return out;
}
/// Share of drops in which each forbidden contact touches, by name.
std::map<std::string, double> touches_of(const BodyRiskResult& r) {
  std::map<std::string, double> out;
  for (const RiskEvent& e : r.risk.events)
    if (e.kind == RiskEvent::Kind::kTouch)
      out[r.scene.robot.contacts[std::size_t(e.point)].name] = double(e.drops) / double(r.risk.peaks.samples);
  return out;
}

void bind_body_risk(py::module_& m) {
  Value<BodyRiskResult> c(m, "RobotRisk", "The peaks of a robot of links over drops that scatter.");
  bind_peak_risk(
      c, "RobotRisk", [](auto& r) -> auto& { return r.risk; });
  property(c, "loads",
           "The loads and limits as RobotScene.loads, each with the drops in which it is beyond its rating and their "
           "share [1].",
           loads_of_risk);
  property(c, "touches", "Of the contacts that must not touch, by name: the share of drops in which one does [1].",
           touches_of);
  bind_report(
      c, tools::kRiskOutputs, [](auto& r) { return r.options.seed; },
      [](auto& r, tools::Run& run) { return report(r.scene, r.motion, r.risk, r.options, run); });
  define(
      m, "risk",
      [](const Arguments& a, const BodyScene& scene, const JointMotions& motions) {
        BodyRiskOptions options{.samples = a.samples, .scatter = parsed_scatter(a.scatter)};
        if (a.drops && a.inexact) throw InputError("inexact: beside drops it has no effect");
        options.drops = {.inflate = inflation(a.inflate), .inexact = a.inexact};
        options.seed = a.seed, options.threads = a.threads;
        options.validate();
        const BodyScene limited = with_limits(scene, a);
        options.measured = measured_drops(a, limited);
        const BodyMotion motion = motions_of(scene, motions);
        const BodyRisk found = monitored([&] { return body_risk(limited, motion, options); }, options.monitor);
        return BodyRiskResult{limited, motion, found, options};
      },
      py::arg("scene"), py::arg("motions"), kScatter, kInflate, kInexact, kSamples.with(BodyRiskOptions().samples),
      kSeed, kThreads, kForbid, kDrops,
      "The same of a robot of links. motions: of its joints by name; one that is not named is held as its scene says.");
}

}  // namespace

void bind_risk(py::module_& m) { bind_distribution(m), bind_paper_risk(m), bind_body_risk(m); }

}  // namespace ukemi::python

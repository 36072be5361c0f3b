// Shared by the bindings of searches and of scatter.
#pragma once

#include "landing/judge/under_scatter.hpp"
#include "landing/model/scatter_file.hpp"
#include "tools/python/landing.hpp"

namespace ukemi::python {

/// Variables on an edge of their range, by name: "lower", "upper".
std::map<std::string, std::string> edges_of(const std::vector<landing::Variable>& variables,
                                            const landing::Edges& edges);
/// The scatter of an argument, if given.
inline std::optional<landing::Scatter> parsed_scatter(const std::optional<std::string>& text) {
  return text ? std::optional(landing::parse_scatter("scatter", *text)) : std::nullopt;
}
/// Measured drops of a file, which replace drawn ones; none without a file. Throws InputError where `scatter` or
/// `inflate` is given too.
std::vector<landing::ScatteredDrop> measured_drops(const std::optional<Path>& file, const landing::Scene& scene,
                                                   const Actuator& actuator, const std::optional<std::string>& scatter,
                                                   double inflate);
/// Checks the number of drops of a search under scatter.
inline long checked_samples(long samples) {
  return long(checked("samples", double(samples), {16, 4096, false, "16 to 4096"}));
}
/// Options of a plan under scatter from arguments.
landing::RobustOptions robust_of(const std::optional<std::string>& measure, const std::optional<std::string>& scatter,
                                 double inflate, long samples);

/// Binds what all risks share; of(result): the risk.
template <class T, class... Options>
void bind_peak_risk(py::class_<T, Options...>& c, const landing::PeakRisk& (*of)(const T&)) {
  using landing::PeakRisk;
  c.def_property_readonly(
       "peaks", [of](const T& x) { return of(x).peaks; }, "Of the motion [m/s^2].")
      .def_property_readonly(
          "held", [of](const T& x) { return of(x).held; }, "Of what is held over the same drops [m/s^2].")
      .def_property_readonly(
          "failed", [of](const T& x) { return of(x).failed; }, "Landings that could not be followed to the floor.")
      .def_property_readonly(
          "joint_lost", [of](const T& x) { return of(x).lost; }, "Of the others, those whose drive lost the joint.")
      .def_property_readonly(
          "from_floor", [of](const T& x) { return of(x).from_floor; },
          "Drops that would begin below the floor: they begin on it.")
      .def_property_readonly(
          "share", [of](const T& x) { return of(x).kept(); }, "The share of drops that keep every limit [1].")
      .def_property_readonly(
          "histogram",
          [of](const T& x) {
            std::vector<double> edges, drops;
            for (const landing::PeakBin& b : of(x).histogram)
              edges.push_back(b.lower), drops.push_back(double(b.drops));
            if (!edges.empty()) edges.push_back(of(x).histogram.back().upper);
            return std::pair(py::array_t<double>(py::ssize_t(drops.size()), drops.data()),
                             py::array_t<double>(py::ssize_t(edges.size()), edges.data()));
          },
          "Drops with a peak in each bin, and the bins' edges [m/s^2], as numpy.histogram gives them.")
      .def_property_readonly(
          "uncertainties",
          [of](const T& x) {
            std::map<std::string, std::pair<double, double>> out;
            for (const PeakRisk::Uncertainty& u : of(x).uncertainties)
              out[u.name] = {u.index.first.value, u.index.total.value};
            return out;
          },
          "Sobol's indices of each group of numbers that scatter: first order and total [1].");
}

}  // namespace ukemi::python

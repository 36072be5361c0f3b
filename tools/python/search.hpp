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
/// Throws InputError where what draws drops is given beside measured ones.
void check_measured(const std::optional<std::string>& scatter, double inflate);
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
template <class T, class Of, class... Options>
void bind_peak_risk(py::class_<T, Options...>& c, Of of) {
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
}

}  // namespace ukemi::python

// Shared by the bindings of maps, for both kinds of robot.
#pragma once

#include "landing/judge/survey.hpp"
#include "tools/python/landing.hpp"

namespace ukemi::python {

/// Indices of the varied variables.
std::vector<int> varied(const landing::PeakMap& map);
/// View of the peaks with an axis for each varied variable; `owner` keeps them alive.
py::array_t<double> peaks_view(const landing::PeakMap& map, py::handle owner);
/// The grid's values of each varied variable by name.
py::dict axes_of(const landing::PeakMap& map);
/// The smallest peak over varied variables number x and y.
Figure figure(const landing::PeakMap& map, int x, int y);

template <class T, class Of, class... Options>
void bind_mapped(py::class_<T, Options...>& c, Of of) {
  c.def_property_readonly(
      "peak", [of](const py::object& self) { return peaks_view(of(self.cast<const T&>()).map, self); },
      "Peaks [m/s^2], of a robot with loads the largest value / rating [1], an axis for each of `axes`; NaN where a "
      "landing could not be followed or breaks a limit.");
  property(c, "axes", "The grid's values along each variable that has a grid, by its name [rad, s or 1].",
           [of](auto& x) { return axes_of(of(x).map); });
  property(c, "failed", "Landings that could not be followed.", [of](auto& x) { return of(x).failed; });
  property(c, "joint_lost", "Landings whose drive lost the joint.", [of](auto& x) { return of(x).lost; });
  c.def(
       "figure", [of](const T& r, int x, int y) { return figure(of(r).map, x, y); }, py::arg("x") = 0, py::arg("y") = 1,
       "The smallest peak [m/s^2] over the variables that are not drawn; x, y: indices of `axes`.")
      .def(
          "_repr_svg_", [of](const T& x) { return figure(of(x).map, 0, 1).svg; }, "What a notebook shows.");
}

}  // namespace ukemi::python

// Shared by the bindings of drop logs and fits to them, for both kinds of robot.
#pragma once

#include "tools/python/value.hpp"
#include "tools/study/floor_fit.hpp"

namespace ukemi::python {

/// Times of a log from release [s]. Throws InputError, which names the log `name`.
std::vector<double> drop_times(const Numbers& t, const std::string& name);
/// A measured output, NaN where it was not measured; empty without values. Throws InputError, which names `name`.
std::vector<double> drop_output(const std::string& output, const std::optional<Numbers>& values, std::size_t rows,
                                const std::string& name);

/// Binds a fit of drops except its estimates; of(result): the fit.
template <class T, class... Options>
void bind_floor_fit(py::class_<T, Options...>& c, const tools::FloorFit& (*of)(const T&)) {
  c.def_property_readonly(
       "model_rejected", [of](const T& x) { return of(x).tests.model_rejected(); },
       "Whether the residuals speak against the floor.")
      .def_property_readonly(
          "drops", [of](const T& x) { return of(x).drops; }, "Each drop beside its log.")
      .def_property_readonly(
          "rms",
          [of](const T& x) {
            const tools::FloorFit& found = of(x);
            std::map<std::string, double> out;
            for (std::size_t o = 0; o < found.channels.size(); ++o)
              if (std::isfinite(found.noise[o])) out[found.channels[o].name] = found.rms[o];
            return out;
          },
          "Residual of each output that was measured, by its name [m/s^2, m or rad].");
}

}  // namespace ukemi::python

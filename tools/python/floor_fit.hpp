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
template <class T, class Of, class... Options>
void bind_floor_fit(py::class_<T, Options...>& c, Of of) {
  property(c, "model_rejected", "Whether the residuals speak against the floor.",
           [of](auto& x) { return of(x).tests.model_rejected(); });
  property(c, "drops", "Each drop beside its log.", [of](auto& x) { return of(x).drops; });
  property(c, "rms", "Residual of each output that was measured, by its name [m/s^2, m or rad].", [of](auto& x) {
    const tools::FloorFit& found = of(x);
    std::map<std::string, double> out;
    for (std::size_t o = 0; o < found.channels.size(); ++o)
      if (std::isfinite(found.noise[o])) out[found.channels[o].name] = found.rms[o];
    return out;
  });
}

}  // namespace ukemi::python

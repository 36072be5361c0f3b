#include "tools/report/landing_sentence.hpp"

#include <fmt/format.h>

#include <cmath>

namespace ukemi::tools {

std::string landing_sentence(double peak, double held) {
  if (!std::isfinite(held)) return fmt::format("Lands with {:.4g} m/s^2.", peak);
  const double less = 100 * (1 - peak / held);
  return fmt::format("Lands with {:.4g} m/s^2 where holding still takes {:.4g}: {:.0f} % {}.", peak, held,
                     std::abs(less), less < 0 ? "harder" : "softer");
}

}  // namespace ukemi::tools

#include "tools/verbs/scattering.hpp"

#include <fmt/format.h>

#include "common/error.hpp"
#include "landing/model/scatter_file.hpp"

namespace ukemi::tools {

void add_scatter(CLI::App& verb, ScatterArguments& a) {
  verb.add_option("--scatter", a.scatter,
                  "NAME=STD,...: standard deviations of pitch_deg, height, forward_speed, pitch_rate_deg, phi_deg, "
                  "rate_deg, delay; of stiffness, damping_normal, damping_tangential as 10% [the scene's, else "
                  "pitch_deg=1,height=0.01,forward_speed=0.03]");
  verb.add_option("--inflate", a.inflate, "factor of the standard errors of the actuator's constants; 0: exact [1]");
}

std::optional<landing::Scatter> scatter_of(const ScatterArguments& a) {
  if (!(a.inflate >= 0 && a.inflate <= 100))
    throw InputError(fmt::format("--inflate: {}: 0 to 100 is needed", a.inflate));
  if (!a.scatter) return std::nullopt;
  return landing::parse_scatter("--scatter", *a.scatter);
}

}  // namespace ukemi::tools

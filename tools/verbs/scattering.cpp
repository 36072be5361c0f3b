#include "tools/verbs/scattering.hpp"

#include <fmt/format.h>

#include "common/error.hpp"
#include "landing/model/scatter_file.hpp"
#include "landing/scatter/drop_file.hpp"

namespace ukemi::tools {

void add_samples(CLI::App& verb, std::optional<long>& samples) {
  verb.add_option("--samples", samples,
                  "with --robust, drops that are searched on, best a power of two [256; of a robot of links 64]");
}
void add_scatter(CLI::App& verb, ScatterArguments& a) {
  verb.add_option("--scatter", a.scatter,
                  "NAME=STD,...: standard deviations of pitch_deg, height, forward_speed, pitch_rate_deg, phi_deg, "
                  "rate_deg, delay; of stiffness, damping_normal, damping_tangential as 10%; of a robot of links also "
                  "slope_deg, and friction, stiffness_tangential, dissipation, pad_thickness, pad_stiffness, "
                  "pad_damping as 10% [the scene's, else pitch_deg=1,height=0.01,forward_speed=0.03]");
  verb.add_option("--inflate", a.inflate, "factor of the standard errors of the actuator's constants; 0: exact [1]");
}
void add_drops(CLI::App& verb, ScatterArguments& a) {
  verb.add_option("--drops", a.drops, "CSV file of drops as they were measured, in place of drawn ones");
}
void ScatterArguments::check_measured() const {
  refuse_beside_drops(scatter.has_value(), "--scatter"), refuse_beside_drops(inflate.has_value(), "--inflate");
}
void ScatterArguments::refuse_beside_drops(bool given, const char* option) const {
  if (given && !drops.empty())
    throw InputError(fmt::format("{}: beside --drops it has no effect: the drops come as they were measured", option));
}

double checked_inflate(const ScatterArguments& a) {
  if (a.inflate && !(*a.inflate >= 0 && *a.inflate <= 100))
    throw InputError(fmt::format("--inflate: {}: 0 to 100 is needed", *a.inflate));
  return a.inflate.value_or(1);
}

Scattering scattering_of(const ScatterArguments& a, const landing::Scene& scene, const Actuator& actuator, Run& run) {
  Scattering out;
  out.inflate = checked_inflate(a);
  if (!a.drops.empty()) {
    a.check_measured();
    run.input(a.drops);
    out.measured = landing::read_drops(a.drops, scene, actuator.sea);
    return out;
  }
  if (a.inflate && actuator.covariance.size() == 0)
    run.warn(fmt::format("--inflate makes no difference: {} holds no [uncertainty], so its constants do not scatter",
                         actuator.name));
  if (a.scatter) out.scatter = landing::parse_scatter("--scatter", *a.scatter);
  (void)landing::DropModel(scene, {}, actuator, {.inflate = out.inflate});  // refuses an invalid covariance
  return out;
}

}  // namespace ukemi::tools

#include "tools/program/actuators.hpp"

#include <fmt/format.h>

#include "common/actuator_constants.hpp"
#include "common/error.hpp"

namespace ukemi::tools {

void warn_of_doubts(const std::string& path, const Verdicts& verdicts, Run& run) {
  if (const std::string untrusted = doubts(verdicts); !untrusted.empty())
    run.warn(fmt::format("{}: not trusted by the fit that wrote it: {}; what follows rests on it", path, untrusted));
}

Actuator actuator_of(const std::string& path, Run& run) {
  Actuator actuator = read_actuator(path);
  run.input(path);
  warn_of_doubts(path, actuator.verdicts, run);
  return actuator;
}

void require_gains(const Actuator& actuator, const Location& where) {
  if (known_command(actuator.sea))
    throw InputError(where,
                     "no k_p and k_d: this drive was identified by its command (k_t); a landing needs the gains "
                     "of its controller, Eq. 3");
}

Actuator landing_actuator_of(const std::string& path, Run& run) {
  Actuator actuator = actuator_of(path, run);
  require_gains(actuator, {path});
  return actuator;
}

Actuator rated_actuator_of(const std::string& path, Run& run) {
  Actuator actuator = landing_actuator_of(path, run);
  warn_of_unknown_ratings(actuator, path, run);
  return actuator;
}

void warn_of_unknown_ratings(const Actuator& actuator, const std::string& path, Run& run) {
  if (const std::string unknown = actuator.unknown_ratings(); !unknown.empty())
    run.warn(fmt::format("{}: the motor's {} unknown ({}): whether it can follow is not checked", path,
                         actuator.speed_max          ? "torque rating is"
                         : actuator.motor_torque_max ? "speed rating is"
                                                     : "ratings of speed and torque are",
                         unknown));
}

}  // namespace ukemi::tools

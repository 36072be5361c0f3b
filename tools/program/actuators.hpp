// Actuator files as the verbs read them.
#pragma once

#include <string>

#include "common/actuator.hpp"
#include "common/error.hpp"
#include "common/verdict.hpp"
#include "tools/program/output.hpp"

namespace ukemi::tools {

/// Warns of the constants that the fit or the calibration that wrote the file did not trust.
void warn_of_doubts(const std::string& path, const Verdicts& verdicts, Run& run);

/// Reads the file, lists it among the run's inputs, and warns of every constant that its fit did not trust.
Actuator actuator_of(const std::string& path, Run& run);

/// actuator_of for a landing: requires K_p and K_d, see require_gains.
Actuator landing_actuator_of(const std::string& path, Run& run);

/// actuator_of for a verb that loads the motor: warns of a rating that the file does not give.
Actuator rated_actuator_of(const std::string& path, Run& run);
void warn_of_unknown_ratings(const Actuator& actuator, const std::string& path, Run& run);

/// Throws InputError where the drive was identified by its command, without K_p and K_d: a landing's motor follows
/// Eq. 3.
void require_gains(const Actuator& actuator, const Location& where);

}  // namespace ukemi::tools

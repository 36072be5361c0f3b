// The table of an actuator's constants: their keys, units and ranges.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/actuator.hpp"
#include "common/toml.hpp"

namespace ukemi {

/// Largest value of control_delay and velocity_filter [s].
inline constexpr double kMaxDelay = 0.1;
Range delay_range();

/// A constant of [actuator].
struct ActuatorConstant {
  const char* key;
  double SeaParameters<double>::*at;
  const char* unit;
  const char* meaning;
  Range range;
  double absent = 0;  ///< value where a file omits the key; not used for the five
};
/// Every constant: the five of the fit, tau_max, then the optional ones.
const std::array<ActuatorConstant, kActuatorConstants>& actuator_constants();
/// The optional constants: a file may omit those that have their default.
std::span<const ActuatorConstant> optional_constants();
/// The keys of all constants: what an actuator's [uncertainty] may name.
const std::vector<std::string>& uncertain_constants();
/// Indices of `names` in actuator_constants(). Throws InputError for another name.
std::vector<int> constant_indices(const std::vector<std::string>& names);

/// Whether its drive was identified by its command alone: K_t replaces K_p and K_d.
bool known_command(const SeaParameters<double>& sea);

/// Reads the constants and the ratings of a section, whose keys are those of [actuator] without its name.
void read_constants(TomlSection& section, Actuator& actuator);
/// Reads `feedback = "output" | "motor"` of a section.
std::optional<Feedback> read_feedback(TomlSection& section);

}  // namespace ukemi

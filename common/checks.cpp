#include "common/checks.hpp"

#include <fmt/format.h>

#include <cmath>

#include "common/actuator_constants.hpp"
#include "common/csv.hpp"
#include "common/uncertainty_file.hpp"

namespace ukemi {

void check_range(std::string_view what, double value, const Range& range) {
  if (!range.holds(value)) throw InputError(fmt::format("{}: {}: must be {}", what, shortest(value), range.rule));
}
void check_finite(std::string_view what, double value) { check_range(what, value, Range::any()); }
void check_positive(std::string_view what, double value) { check_range(what, value, Range::positive()); }
void check_not_negative(std::string_view what, double value) { check_range(what, value, Range::non_negative()); }
void check_count(std::string_view what, long value, long lowest, long highest) {
  if (value < lowest || value > highest)
    throw InputError(fmt::format("{}: {}: {} to {} are needed", what, value, lowest, highest));
}

void check(const Uncertainty& uncertainty, const std::vector<std::string>& known, const std::string& owner) {
  if (const auto [key, message] = fault_of(uncertainty, known, owner); !message.empty())
    throw InputError(key + ": " + message);
}

void validate(const SeaParameters<double>& sea) {
  for (const ActuatorConstant& c : actuator_constants())
    if (const double v = sea.*c.at; v != c.absent || std::isfinite(v)) check_range(c.key, v, c.range);
}

void validate(const Actuator& actuator) {
  validate(actuator.sea);
  if (actuator.speed_max) check_positive("speed_max", *actuator.speed_max);
  if (actuator.motor_torque_max) check_positive("motor_torque_max", *actuator.motor_torque_max);
  check({actuator.uncertain, actuator.covariance}, uncertain_constants(), "the actuator");
}

}  // namespace ukemi

// The ranges of the public structs' numbers, checked once at the entry points of a library.
#pragma once

#include <string_view>

#include "common/actuator.hpp"
#include "common/toml.hpp"
#include "common/uncertainty.hpp"

namespace ukemi {

/// Each throws InputError "WHAT: VALUE: RULE" unless the value is within the range; finite; above 0; at least 0,
/// respectively. Nothing is allocated where the check passes.
void check_range(std::string_view what, double value, const Range& range);
void check_finite(std::string_view what, double value);
void check_positive(std::string_view what, double value);
void check_not_negative(std::string_view what, double value);
/// Throws InputError unless lowest <= value <= highest.
void check_count(std::string_view what, long value, long lowest, long highest);

/// Throws InputError unless each name occurs once and is one of `known`, which are constants of `owner`, and the
/// covariance is a symmetric matrix of their size, finite, without a variance below 0.
void check(const Uncertainty& uncertainty, const std::vector<std::string>& known, const std::string& owner);

/// Throws InputError for a constant outside its range; tau_max may be infinite. With an Actuator, for its ratings and
/// its covariance too: whatever read_actuator refuses.
void validate(const SeaParameters<double>& sea);
void validate(const Actuator& actuator);

}  // namespace ukemi

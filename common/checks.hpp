// The ranges of the public structs' numbers, checked once where a library is entered.
#pragma once

#include <string_view>

#include "common/actuator.hpp"
#include "common/toml.hpp"
#include "common/uncertainty.hpp"

namespace ukemi {

/// Each throws InputError "WHAT: VALUE: RULE" unless the value is within the range; finite; above 0; at least 0.
/// Nothing is allocated where it is.
void check_range(std::string_view what, double value, const Range& range);
void check_finite(std::string_view what, double value);
void check_positive(std::string_view what, double value);
void check_not_negative(std::string_view what, double value);
/// Throws also unless there are that many numbers.
void check_count(std::string_view what, long value, long least, long most);

/// Throws InputError unless each name occurs once and is one of `known`, which are constants of `whom`, and the
/// covariance is a symmetric matrix of their size, finite, without a variance below 0.
void check(const Uncertainty& uncertainty, const std::vector<std::string>& known, const std::string& whom);

/// Throws InputError for a constant outside its range; tau_max may be infinite. With an Actuator, for its ratings and
/// its covariance too: whatever read_actuator refuses.
void validate(const SeaParameters<double>& sea);
void validate(const Actuator& actuator);

}  // namespace ukemi

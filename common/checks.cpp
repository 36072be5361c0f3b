#include "common/checks.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "common/csv.hpp"

namespace ukemi {

namespace {
void check(std::string_view what, double value, bool good, const char* rule) {
  if (!(std::isfinite(value) && good)) throw InputError(fmt::format("{}: {}: must be {}", what, shortest(value), rule));
}
}  // namespace

void check_finite(std::string_view what, double value) { check(what, value, true, "a finite number"); }
void check_positive(std::string_view what, double value) { check(what, value, value > 0, "above 0"); }
void check_not_negative(std::string_view what, double value) { check(what, value, value >= 0, "at least 0"); }
void check_count(std::string_view what, long value, long least, long most) {
  if (value < least || value > most)
    throw InputError(fmt::format("{}: {}: {} to {} are needed", what, value, least, most));
}

void check(const Uncertainty& uncertainty, const std::vector<std::string>& known, const std::string& whom) {
  if (const auto [key, message] = fault_of(uncertainty, known, whom); !message.empty())
    throw InputError(key + ": " + message);
}

void validate(const SeaParameters<double>& sea) {
  const std::array<double, kConstants> u = constants(sea);
  for (std::size_t k = 0; k + 1 < kConstants; ++k) check_not_negative(kConstantNames[k], u[k]);
  check_positive(kConstantNames[kConstants - 1], u[kConstants - 1]);
  if (sea.tau_max != std::numeric_limits<double>::infinity()) check_not_negative("tau_max", sea.tau_max);
  for (const OptionalConstant& c : optional_constants()) {
    const double x = sea.*c.at;
    const Range& r = c.range;
    check(c.key, x, x >= r.low && x <= r.high && !(r.low_open && x == r.low), r.rule.c_str());
  }
}

void validate(const Actuator& actuator) {
  validate(actuator.sea);
  if (actuator.speed_max) check_positive("speed_max", *actuator.speed_max);
  std::vector<std::string> known(kConstantNames.begin(), kConstantNames.end());
  for (const OptionalConstant& c : optional_constants()) known.emplace_back(c.key);
  check({actuator.uncertain, actuator.covariance}, known, "the actuator");
}

}  // namespace ukemi

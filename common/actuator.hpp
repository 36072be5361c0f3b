// An actuator as a file: the constants of Eq. 2-4, its ratings, how far the constants can be trusted, where they come
// from.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/sea_parameters.hpp"
#include "common/uncertainty.hpp"
#include "common/verdict.hpp"

namespace ukemi {

/// The five constants of the fit, in the order of U = [K_p K_d K_SEA C_SEA I_motor] (Sec. 3 of [1]).
inline constexpr std::array kConstantNames = {"k_p", "k_d", "k_sea", "c_sea", "i_motor"};
inline constexpr std::array kConstantUnits = {"Nm/rad", "Nm/(rad/s)", "Nm/rad", "Nm/(rad/s)", "kg m^2"};
inline constexpr int kConstants = int(kConstantNames.size());
static_assert(kConstantUnits.size() == kConstants);
/// The five constants as a vector; `set_constants` leaves the other fields of `sea` unchanged.
template <class T>
std::array<T, kConstants> constants(const SeaParameters<T>& sea) {
  return std::array{sea.k_p, sea.k_d, sea.k_sea, sea.c_sea, sea.i_motor};
}
template <class T, class Vector>
void set_constants(SeaParameters<T>& sea, const Vector& u) {
  sea.k_p = u[0], sea.k_d = u[1], sea.k_sea = u[2], sea.c_sea = u[3], sea.i_motor = u[4];
}

/// Number of an actuator's constants: those five, tau_max, the optional ones. sizeof counts `feedback` as one more.
inline constexpr int kActuatorConstants = int(sizeof(SeaParameters<double>) / sizeof(double)) - 1;

struct Actuator {
  std::string name;
  SeaParameters<double> sea;
  std::optional<double> speed_max;         ///< rated motor speed at the output [rad/s]; a rating, not a term
  std::optional<double> motor_torque_max;  ///< rated motor torque at the output [Nm]; sea.tau_max limits the spring
  std::vector<std::string> uncertain;      ///< [uncertainty] order: the constants that were fitted
  DenseMatrix covariance;                  ///< of `uncertain`, in that order, SI
  /// [verdict]: how far the fit that found a constant may be relied on, in the order of kConstantNames; empty where the
  /// file says nothing.
  Verdicts verdicts;
  std::vector<std::pair<std::string, std::string>> provenance;  ///< written as text

  /// Keys of the ratings that are not known, "speed_max, motor_torque_max"; empty where both are.
  std::string unknown_ratings() const;
  /// Standard error of a constant, where the file gives one.
  std::optional<double> standard_error(const std::string& constant) const;
};

/// Reads an actuator file; throws InputError with file:line:column.
Actuator read_actuator(const std::string& path);

/// The file's text: [actuator], with verdicts [verdict], with a covariance [uncertainty] (order, std, ci95,
/// covariance), and [provenance]. `half_width` is the factor from a standard error to the half width of the 95 %
/// interval.
std::string to_toml(const Actuator& actuator, double half_width = kNormal975);

}  // namespace ukemi

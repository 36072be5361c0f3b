// The log of one drop in SI units, with the checks that a log must pass.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "landing/drops/drop_rollout.hpp"

namespace ukemi::landing {

/// A log of the thigh. An output has as many samples as `t`, NaN where it was not measured, or none at all.
struct DropLog {
  std::string file;
  std::vector<double> t;  ///< from release [s], increasing, >= 0
  std::array<std::vector<double>, kOutputs> output;
  long before_release = 0;  ///< rows with t < 0, which are left out

  /// Measured values of an output.
  long count(DropOutput o) const;
};

/// Reads a drop (CSV). Columns by name: t [s] or t_ms, and at least one of acc, ax, ay [m/s^2] (or acc_g, ..., times
/// 9.80665), x_0, y_0 [m] (or x_0_mm, y_0_mm), phi_0 [rad] (or phi_0_deg); other columns are not read. An empty cell of
/// an output: not measured then, so that sensors of several rates share a file. Throws InputError with
/// file:line:column on whatever read_csv refuses, on a missing column (nearest name given), an output in two units,
/// fewer than two rows from the release on, an empty time, a time_fault, rows that begin 1e5 s or more after the
/// release (then t counts from elsewhere), and an angle beyond 2 pi.
DropLog read_drop(const std::string& path);

}  // namespace ukemi::landing

// What a fit promises of logs that it has not seen: bands of outputs and of times, by how a prediction moves with the
// errors of its constants. Ours. Tests: test/legs/promises.cpp.
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "common/uncertainty.hpp"
#include "tools/study/drop_simulator.hpp"

namespace ukemi::tools {

struct CalibrationOptions;
struct FloorFit;

/// What a fit knows: how well its constants, and what it left of its logs in each output, by name, at least their
/// noise.
struct Identified {
  Uncertainty constants;
  std::map<std::string, double> rms;
};

/// What a fit promises of a drop that it has not seen.
struct Promise {
  /// Of DropResult::value: half of the 95 % band about it, of the constants' errors and of what the fit left, or where
  /// that is not known or less, of the log's noise.
  std::vector<std::vector<double>> band;
  /// How each of DropResult::changes moves [s] with errors that are independent and of variance 1, a column each.
  Eigen::MatrixXd change;
  bool known() const { return !band.empty(); }
  /// Of the time of a change, and of that between two [s].
  double half_band(std::size_t i) const { return kNormal975 * change.row(long(i)).norm(); }
  double half_band(std::size_t i, std::size_t j) const {
    return kNormal975 * (change.row(long(j)) - change.row(long(i))).norm();
  }
};

/// What constants that are `known` so well promise of the drops that validate_floor has played with them. A constant
/// moves by a tenth of its standard error, and what is each drop's own follows as if it were fitted again. Constants
/// that are no terms of the table have no say. Nothing of a drop that cannot be followed so; NaN of contacts that then
/// come in another order.
[[nodiscard]] std::vector<Promise> promises(const DropSimulator& drops, const CalibrationOptions& options,
                                            const FloorFit& predicted, const Identified& known);

}  // namespace ukemi::tools

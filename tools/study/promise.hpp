// Prediction bands for logs that were not fitted: of outputs and of contact times, by linear propagation of the errors
// of the constants. Ours. Tests: test/legs/promises.cpp.
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

/// Uncertainty of a fit: its constants' covariance, and the rms residual of each output, at least the logs' noise.
struct FitUncertainty {
  Uncertainty constants;
  std::map<std::string, double> rms;
};

/// Prediction bands of one drop.
struct PredictionBands {
  /// Half-widths of the 95 % bands about DropResult::value, from the constants' errors and the larger of the fit's
  /// residual and the log's noise.
  std::vector<std::vector<double>> band;
  /// Derivatives of the times of DropResult::changes by independent errors of variance 1 [s], a column each.
  Eigen::MatrixXd change;
  bool known() const { return !band.empty(); }
  /// Half-widths of the 95 % bands of the time of a change, and of the time between two [s].
  double half_band(std::size_t i) const { return kNormal975 * change.row(long(i)).norm(); }
  double half_band(std::size_t i, std::size_t j) const {
    return kNormal975 * (change.row(long(j)) - change.row(long(i))).norm();
  }
};

/// Prediction bands of the drops that validate_floor has simulated, given the uncertainty of the constants. Derivatives
/// are differences over a tenth of a standard error, the nuisance terms of each drop refitted to first order. Constants
/// that are not terms of the table are ignored. Empty for a drop that cannot be simulated with perturbed constants;
/// times are NaN where the order of its contacts then changes.
[[nodiscard]] std::vector<PredictionBands> predict_bands(const DropSimulator& drops, const CalibrationOptions& options,
                                                         const FloorFit& predicted, const FitUncertainty& uncertainty);

}  // namespace ukemi::tools

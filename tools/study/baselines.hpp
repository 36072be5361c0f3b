// Baseline predictions without physics; a model that does not beat them does not explain the trials.
//
// No printing, no files. Tests: test/legs/driven.cpp.
#pragma once

#include <limits>
#include <vector>

#include "tools/study/floor_fit.hpp"

namespace ukemi::tools {

/// RMS residuals of one channel over all trials, on the same samples, in its unit; NaN: not known.
struct Baseline {
  double model = std::numeric_limits<double>::quiet_NaN();
  double held = model;  ///< of each trial's first measured value, held constant
  double mean = model;  ///< of the mean of the other trials at the same time from their start; at least three trials

  bool known() const { return held == held; }
  /// Whether the model has smaller residuals than every known baseline.
  bool beaten() const { return model < held && !(model >= mean); }
};
/// The baselines of each channel.
std::vector<Baseline> baselines(const FloorFit& played, const std::vector<const landing::DropLog*>& logs);

}  // namespace ukemi::tools

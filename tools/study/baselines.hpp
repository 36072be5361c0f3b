// Predictions of trials that know no physics: what a model does not beat it has not explained.
//
// No printing, no files. Tests: test/legs/driven.cpp.
#pragma once

#include <limits>
#include <vector>

#include "tools/study/floor_fit.hpp"

namespace ukemi::tools {

/// Residuals of one channel over all trials, rms on the same samples, in its unit; NaN: not known.
struct Baseline {
  double model = std::numeric_limits<double>::quiet_NaN();
  double held = model;  ///< each trial's first measured value, held
  double mean = model;  ///< the mean of the other trials at the same time from their start; three trials at least

  bool known() const { return held == held; }
  /// Whether the model is nearer than all that is known.
  bool beaten() const { return model < held && !(model >= mean); }
};
/// Of each channel.
std::vector<Baseline> baselines(const FloorFit& played, const std::vector<const landing::DropLog*>& logs);

}  // namespace ukemi::tools

// The goal of a search under scatter: a measure of the peaks over scattered drops, the same drops for every motion.
#pragma once

#include <vector>

#include "landing/scatter/drop_model.hpp"
#include "landing/scatter/measure.hpp"

namespace ukemi::landing {

struct Robust {
  /// Accuracy of the landings of such a search: peaks to 1e-4 or so.
  static constexpr double kAccuracy = 1e-5;
  Measure measure;
  std::vector<ScatteredDrop> drops;  ///< that are searched on
  std::vector<ScatteredDrop>
      judging;            ///< that the best few are judged on: their value is what is promised; none: as found
  double penalty = 1000;  ///< what a landing that breaks a limit counts [m/s^2]
};

}  // namespace ukemi::landing

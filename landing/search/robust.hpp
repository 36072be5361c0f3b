// The goal of a search under scatter: a measure of the peaks over scattered drops, the same drops for every motion.
#pragma once

#include <vector>

#include "landing/scatter/drop_model.hpp"
#include "landing/scatter/measure.hpp"

namespace ukemi::landing {

struct Robust {
  /// Accuracy of the landings: peaks to about 1e-4 relative.
  static constexpr double kAccuracy = 1e-5;
  Measure measure;
  std::vector<ScatteredDrop> drops;    ///< of the search
  std::vector<ScatteredDrop> judging;  ///< on which the best few are evaluated for the promised value; empty: as found
  double penalty = 1000;               ///< value of a landing that breaks a limit [m/s^2]
};

}  // namespace ukemi::landing

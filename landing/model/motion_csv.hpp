// Tolerances for recovering a motion from the rows of a motion.csv.
#pragma once

#include "landing/model/files.hpp"

namespace ukemi::landing {

/// Maximum deviation of a row from the recovered motion.
inline constexpr double kAngleMisfit = 1e-4,  ///< [rad]
    kRateMisfit = 1e-2;                       ///< [rad/s]
/// Minimum number of rows inside a moving piece of the reference: more than its unknowns.
inline constexpr int kLeastRows = kMaxBumps + 1;

}  // namespace ukemi::landing

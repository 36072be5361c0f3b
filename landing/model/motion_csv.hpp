// How exactly the rows of a motion.csv must be those of a motion.
#pragma once

#include "landing/model/files.hpp"

namespace ukemi::landing {

/// Rows are those of a motion where none is farther from it than this.
inline constexpr double kAngleMisfit = 1e-4,  ///< [rad]
    kRateMisfit = 1e-2;                       ///< [rad/s]
/// Least number of rows inside a piece of the reference that moves: more than it has unknowns.
inline constexpr int kLeastRows = kMostBumps + 1;

}  // namespace ukemi::landing

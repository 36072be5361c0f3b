// Kinds of local maxima of a landing's acceleration.
#pragma once

namespace ukemi::landing {

/// Place of a local maximum, which determines its derivative.
enum class PeakKind : unsigned char {
  kInside,      ///< in a smooth phase: at a fixed time
  kRightLimit,  ///< just after an event, at the event's moving time
  kLeftLimit,   ///< just before an event or the end of the run, at its moving time
};

}  // namespace ukemi::landing

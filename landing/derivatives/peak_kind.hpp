// Where a local maximum of a landing's acceleration lies.
#pragma once

namespace ukemi::landing {

/// Where a local maximum lies, and so how its derivative is taken.
enum class PeakKind : unsigned char {
  kInside,      ///< in a smooth phase: at a fixed time
  kRightLimit,  ///< just after an event, at the event's moving time
  kLeftLimit,   ///< just before an event or the end of the run, likewise
};

}  // namespace ukemi::landing

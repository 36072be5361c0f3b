// How steps grow and shrink, for the scalar driver (hybrid.hpp) and the lanes of landing alike: h_new = h * factor,
// factor = safety * (tolerance / error)^(1 / (order + 1)), within [least, most].
// Source: Hairer, Norsett, Wanner, "Solving Ordinary Differential Equations I" (1993), II.4, Eq. 4.13, whose ranges
// they keep. `ukemi bench integrators` shows what they do to error against run time.
#pragma once

namespace ukemi::integrate {

struct StepControl {
  double safety = 0.9;   ///< 0.8..0.95: nearer to 1, more steps are rejected
  double least = 0.2;    ///< 0.1..0.5: a step never shrinks by more, unless its error is no number
  double most = 8;       ///< 1.5..10: or grows by more; after a rejected step not at all
  double broken = 0.1;   ///< where the error is no number, or beyond 1e10 tolerances
  double slack = 1.001;  ///< a step that would leave less than 0.1 % of itself before a stop goes to the stop
};
inline constexpr StepControl kStepControl;

/// Events at one instant until a run counts as stuck: more than a landing's eight guards can change, several times
/// over.
inline constexpr int kMostImmediate = 64;

}  // namespace ukemi::integrate

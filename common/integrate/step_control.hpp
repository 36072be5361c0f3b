// Step-size control of the scalar driver (hybrid.hpp) and of the lanes of landing: h_new = h * factor,
// factor = safety * (tolerance / error)^(1 / (order + 1)), within [min, max].
// Source: Hairer, Norsett, Wanner, "Solving Ordinary Differential Equations I" (1993), II.4, Eq. 4.13; the
// ranges below are theirs. `ukemi bench integrators` shows what they do to error against run time.
#pragma once

namespace ukemi::integrate {

struct StepControl {
  double safety = 0.9;   ///< 0.8..0.95: closer to 1, more steps are rejected
  double min = 0.2;      ///< smallest factor, 0.1..0.5, unless the error is NaN
  double max = 8;        ///< largest factor, 1.5..10; 1 after a rejected step
  double failed = 0.1;   ///< factor where the error is NaN, or beyond 1e10 tolerances
  double slack = 1.001;  ///< a step that would leave less than 0.1 % of itself before a stop goes to the stop
};
inline constexpr StepControl kStepControl;

/// Events at one instant beyond which a run counts as stuck: several times what a landing's eight guards can change.
inline constexpr int kMaxImmediateEvents = 64;

}  // namespace ukemi::integrate

// How a step of an integrator ended, and counts of its work.
#pragma once

namespace ukemi::integrate {

enum class Status {
  kStepped,    ///< the step was taken; there may be more
  kReached,    ///< the step ended at the stop time
  kEvent,      ///< the step ended on a guard's zero (or had length zero: `immediate`)
  kTooSmall,   ///< the error control needs a step below the resolution of time
  kNotFinite,  ///< the field is not finite where the step starts
  kStuck,      ///< too many events at one instant
};

/// Work done so far.
struct Counters {
  long steps = 0, rejected = 0, derivatives = 0, jacobians = 0, events = 0;
  long implicit = 0;  ///< steps that an automatic method took implicitly

  Counters& operator+=(const Counters& o) {
    steps += o.steps, rejected += o.rejected, derivatives += o.derivatives, jacobians += o.jacobians;
    events += o.events, implicit += o.implicit;
    return *this;
  }
};

}  // namespace ukemi::integrate

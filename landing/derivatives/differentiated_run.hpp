// A landing in scalars with derivatives, from event to event, and who watches it. Of any robot.
#pragma once

#include <limits>
#include <optional>

#include "common/integrate/saltation.hpp"
#include "landing/run/simulate.hpp"

namespace ukemi::landing {

/// How it ended.
struct DifferentiatedOutcome {
  double t_end = 0;
  End end = End::kFailed;
  integrate::Status status = integrate::Status::kStepped;
  integrate::Counters work;
};

/// What a deadline means: the end, or that the landing motion starts now, at a time that moves with the first
/// touchdown. The field is continuous at every other.
struct Deadline {
  std::optional<End> end;
  bool lands = false;
};

/// Steps a landing from the state `start` at time t to its end. `Landing` tells its course: step_options, open,
/// longest_step, stop, reached, land, cross, rests, end_moves; system() and, in the same mode, plain() in doubles. An
/// observer sees, in this order of time:
///   begin(landing, t, y)                    where the integration starts
///   step(landing, driver)                   a step of positive length, in the mode before its event
///   before(landing, t, y, dy, shift)        the left limit of an event; `shift` is dt*/dp of its time t*
///   after_event(landing, t, y, shift, event)     the right limit, in the mode beyond guard `event`
///   cut(landing, t, y, dy, shift)           the time limit
///   finish(landing)
/// (of the paper's robot before all flight(landing, y, until), the closed-form flight from the state y at release) and
/// says by running() the largest |ddr_0|^2 so far, which rest is judged by (asked for with Rest::kStop alone).
template <class Landing, class Observer>
class DifferentiatedRun {
  using Jet = typename Landing::Jet;
  using Derivatives = typename Landing::Derivatives;
  using State = typename Landing::State;
  using Driver = typename Landing::Driver;

 public:
  DifferentiatedRun(Landing& landing, Observer& observer) : l_(landing), observer_(observer) {}

  DifferentiatedOutcome follow(double t, const State& start) {
    const SimulateOptions& options = l_.options();
    Driver driver(l_.system(), t, start, l_.step_options());
    DifferentiatedOutcome out;
    l_.open(t, start);
    observer_.begin(l_, t, start);
    for (long n = 0;; ++n) {
      if (const double longest = l_.longest_step(); longest < std::numeric_limits<double>::infinity())
        driver.limit_next_step(longest);
      const integrate::Outcome outcome = driver.step(l_.stop());
      t = driver.time();
      out.status = outcome.status;
      if (outcome.status > integrate::Status::kEvent || n >= options.max_steps || options.stopped(n)) break;
      if (!outcome.immediate && driver.step().h > 0) observer_.step(l_, driver);
      if (outcome.event >= 0) {
        if (cross(t, driver, outcome.event)) continue;
        out.status = integrate::Status::kNotFinite;
        break;
      }
      if (outcome.status == integrate::Status::kReached && (out.end = reached(t, driver)) != End::kFailed) break;
      if (options.rest == SimulateOptions::Rest::kStop &&
          l_.rests(t, Landing::values(driver.state()), observer_.running())) {
        out.end = End::kRest;
        break;
      }
    }
    observer_.finish(l_);
    out.t_end = t;
    out.work = driver.counters();
    return out;
  }

 private:
  /// At a deadline; kFailed where the run goes on.
  End reached(double t, Driver& driver) {
    const Deadline deadline = l_.reached(t);
    if (deadline.end) {
      observer_.cut(l_, t, driver.state(), driver.slope(), l_.end_moves() ? touchdown_ : Derivatives::Zero().eval());
      return *deadline.end;
    }
    constexpr int kNoGuard = Landing::System::kGuards;
    if (deadline.lands) jump(t, driver, touchdown_, kNoGuard, [&](State& y) { l_.land(Jet(t, touchdown_), y); });
    return End::kFailed;
  }

  /// Into the mode beyond guard `event`, the derivatives with it; false where its time has no derivative.
  bool cross(double t, Driver& driver, int event) {
    integrate::Guards<Landing::System::kGuards, Jet> guards;
    l_.system().guards(t, driver.state(), driver.slope(), guards);
    const double rate = value_of(guards.rate[event]);
    // At no speed the time of an event has no derivative, but by what the guard does not depend on: a robot that is
    // released on the floor touches it at release, whatever its motion.
    constexpr double kRounding = 1e-12;
    const Derivatives shift = rate == 0 && guards.value[event].v.isZero(kRounding)
                                  ? Derivatives(Derivatives::Zero())
                                  : Derivatives(integrate::event_shift(guards.value[event], rate));
    if (!shift.allFinite()) return false;
    jump(t, driver, shift, event, [&](State& y) {
      if (l_.cross(event, Jet(t, shift), y)) touchdown_ = shift;
    });
    return true;
  }

  /// Through a change of the field, and maybe of the state, at a time that moves by `shift`.
  template <class Change>
  void jump(double t, Driver& driver, const Derivatives& shift, int event, Change&& change) {
    observer_.before(l_, t, driver.state(), driver.slope(), shift);
    State y = driver.state();
    integrate::move_along(y, Landing::values(driver.slope()), shift);
    change(y);
    integrate::move_along(y, l_.plain().derivative(t, Landing::values(y)), Derivatives(-shift));
    driver.refresh(y);
    observer_.after_event(l_, t, y, shift, event);
  }

  Landing& l_;
  Observer& observer_;
  Derivatives touchdown_ = Derivatives::Zero();  ///< dt_0/dp of the first
};

template <class Landing, class Observer>
DifferentiatedOutcome follow_with_derivatives(Landing& landing, double t, const typename Landing::State& start,
                                              Observer& observer) {
  return DifferentiatedRun<Landing, Observer>(landing, observer).follow(t, start);
}

}  // namespace ukemi::landing

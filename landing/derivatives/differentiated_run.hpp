// A landing of any robot in scalars with derivatives, from event to event, with an observer.
#pragma once

#include <limits>
#include <optional>

#include "common/integrate/saltation.hpp"
#include "landing/run/simulate.hpp"

namespace ukemi::landing {

/// How a run ended.
struct DifferentiatedOutcome {
  double t_end = 0;
  End end = End::kFailed;
  integrate::Status status = integrate::Status::kStepped;
  integrate::Counters work;
};

/// The effect of a deadline: the end of the run, or the start of the landing motion, at a time that moves with the
/// first touchdown. The field is continuous at other deadlines.
struct Deadline {
  std::optional<End> end;
  bool lands = false;
};

/// Steps a landing from the state `start` at time t to its end. `Landing` provides its course: step_options, open,
/// longest_step, stop, reached, land, cross, rests, end_moves; system() and, in the same mode, plain() in doubles. An
/// observer sees, in this order of time:
///   fall(landing, fall)                     if it has one: the free fall before, a BodyCourse::Fall
///   begin(landing, t, y)                    where the integration starts
///   step(landing, driver)                   a step of positive length, in the mode before its event
///   before_event(landing, t, y, dy, shift)  the left limit of an event; `shift` is dt*/dp of its time t*
///   after_event(landing, t, y, shift, event) the right limit, in the mode after guard `event`
///   time_limit(landing, t, y, dy, shift)    the end of the run by its time limit
///   finish(landing)
/// With Rest::kStop it returns by running() the largest |ddr_0|^2 so far, for the rest test.
template <class Landing, class Observer>
class DifferentiatedRun {
  using Jet = typename Landing::Jet;
  using Derivatives = typename Landing::Derivatives;
  using State = typename Landing::State;
  using Driver = typename Landing::Driver;

 public:
  DifferentiatedRun(Landing& landing, Observer& observer) : landing_(landing), observer_(observer) {}

  DifferentiatedOutcome follow(double t, const State& start) {
    const SimulateOptions& options = landing_.options();
    Driver driver(landing_.system(), t, start, landing_.step_options());
    DifferentiatedOutcome out;
    landing_.open(t, start);
    observer_.begin(landing_, t, start);
    for (long n = 0;; ++n) {
      if (const double longest = landing_.longest_step(); longest < std::numeric_limits<double>::infinity())
        driver.limit_next_step(longest);
      const integrate::Outcome outcome = driver.step(landing_.stop());
      t = driver.time();
      out.status = outcome.status;
      if (outcome.status > integrate::Status::kEvent || n >= options.max_steps || options.stopped(n)) break;
      if (!outcome.immediate && driver.step().h > 0) observer_.step(landing_, driver);
      if (outcome.event >= 0) {
        if (cross(t, driver, outcome.event)) continue;
        out.status = integrate::Status::kNotFinite;
        break;
      }
      if (outcome.status == integrate::Status::kReached && (out.end = reached(t, driver)) != End::kFailed) break;
      if (options.rest == SimulateOptions::Rest::kStop &&
          landing_.rests(t, Landing::values(driver.state()), observer_.running())) {
        out.end = End::kRest;
        break;
      }
    }
    observer_.finish(landing_);
    out.t_end = t;
    out.work = driver.counters();
    return out;
  }

 private:
  /// Handles a deadline; kFailed if the run continues.
  End reached(double t, Driver& driver) {
    const Deadline deadline = landing_.reached(t);
    if (deadline.end) {
      observer_.time_limit(landing_, t, driver.state(), driver.slope(),
                           landing_.end_moves() ? touchdown_shift_ : Derivatives::Zero().eval());
      return *deadline.end;
    }
    constexpr int kNoGuard = Landing::System::kGuards;
    if (deadline.lands)
      jump(t, driver, touchdown_shift_, kNoGuard, [&](State& y) { landing_.land(Jet(t, touchdown_shift_), y); });
    return End::kFailed;
  }

  /// Crosses guard `event` with the derivatives; false if its time has no derivative.
  bool cross(double t, Driver& driver, int event) {
    integrate::Guards<Landing::System::kGuards, Jet> guards;
    landing_.system().guards(t, driver.state(), driver.slope(), guards);
    const double rate = value_of(guards.rate[event]);
    // At zero rate the time of an event has a derivative, 0, only if the guard depends on no parameter: a robot
    // released on the floor touches it at release for any motion.
    constexpr double kRounding = 1e-12;
    const Derivatives shift = rate == 0 && guards.value[event].v.isZero(kRounding)
                                  ? Derivatives(Derivatives::Zero())
                                  : Derivatives(integrate::event_shift(guards.value[event], rate));
    if (!shift.allFinite()) return false;
    jump(t, driver, shift, event, [&](State& y) {
      if (landing_.cross(event, Jet(t, shift), y)) touchdown_shift_ = shift;
    });
    return true;
  }

  /// Carries the derivatives through a change of the field, and maybe of the state, at a time that moves by `shift`.
  template <class Change>
  void jump(double t, Driver& driver, const Derivatives& shift, int event, Change&& change) {
    observer_.before_event(landing_, t, driver.state(), driver.slope(), shift);
    State y = driver.state();
    integrate::move_along(y, Landing::values(driver.slope()), shift);
    change(y);
    integrate::move_along(y, landing_.plain().derivative(t, Landing::values(y)), Derivatives(-shift));
    driver.refresh(y);
    observer_.after_event(landing_, t, y, shift, event);
  }

  Landing& landing_;
  Observer& observer_;
  Derivatives touchdown_shift_ = Derivatives::Zero();  ///< dt_0/dp of the first touchdown
};

template <class Landing, class Observer>
DifferentiatedOutcome follow_with_derivatives(Landing& landing, double t, const typename Landing::State& start,
                                              Observer& observer) {
  return DifferentiatedRun<Landing, Observer>(landing, observer).follow(t, start);
}

}  // namespace ukemi::landing

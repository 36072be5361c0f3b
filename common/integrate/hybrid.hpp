// The adaptive driver for systems that are smooth between events.
//
// A system holds its discrete mode (which points touch, which limit acts) and defines guards: functions of the state
// that are positive while the mode is valid. The driver integrates the smooth field of the present mode, shortens a
// step that would pass a guard's zero to end there, and returns; the caller changes the mode and continues.
//
// Rules at and after an event:
//   - a step never crosses a guard's zero: the zero is located on the step's dense output, the step is retaken with
//     that length until the zero is within kMaxShift of its end, relative to it, and its end is moved along the field;
//   - the system flips the guard's sign in `cross`; a guard that starts within rounding of zero and rises is left alone
//     (no sticking), one that starts at or below zero and falls is an event of length zero (simultaneous touchdowns);
//   - events inside a step: each guard's cubic through both ends' values and rates is bounded by its Bernstein
//     coefficients; where the bound is near zero the dense output is searched in four parts (no missed grazing);
//   - more than kMaxImmediateEvents events at one instant end the run as kStuck.
#pragma once

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>
#include <limits>

#include "common/integrate/counters.hpp"
#include "common/integrate/guards.hpp"
#include "common/integrate/runge_kutta.hpp"
#include "common/integrate/step_control.hpp"

namespace ukemi::integrate {

inline const char* name(Status status) {
  constexpr const char* kOnItsWay = "on its way";
  constexpr const char* kNames[] = {kOnItsWay,
                                    kOnItsWay,
                                    kOnItsWay,
                                    "the steps become smaller than time resolves",
                                    "the motion is no longer finite",
                                    "too many events at one instant"};
  return kNames[int(status)];
}

struct Outcome {
  Status status;
  int event = -1;          ///< index of the guard, with kEvent
  bool immediate = false;  ///< the event took no time: no step was made
};

struct Options {
  double accuracy = 1e-8;    ///< relative tolerance of each step, and absolute in the system's units
  double first_step = 1e-4;  ///< [s]
  double max_step = std::numeric_limits<double>::infinity();  ///< [s]
};

/// Interface of a system. `derivative` is smooth for the present mode; `tolerance_unit(i)` is the size of component i
/// below which its error is absolute; only the first kControlled components enter the step control.
template <class S>
concept HybridSystem = requires(const S& s, double t, const typename S::State& y, typename S::State& dy,
                                Guards<S::kGuards>& g) {
  {s.derivative(t, y, dy)};
  {s.guards(t, y, y, g)};
  { s.tolerance_unit(0) } -> std::convertible_to<double>;
  S::kControlled;
};

/// Integrates `System` from event to event. The system is referenced, not owned; after an event change its mode, then
/// continue.
template <class Method, class System>
class Integrator {
 public:
  static constexpr int kGuards = System::kGuards;
  using State = typename System::State;
  using Scalar = typename State::Scalar;
  using StepT = typename StepOf<Method, Scalar, State::RowsAtCompileTime, System::kControlled>::type;

  Integrator(const System& system, double t, const State& y, const Options& options)
      : system_(system), options_(options), h_next_(options.first_step) {
    tolerance_.accuracy = options.accuracy;
    for (int i = 0; i < System::kControlled; ++i) tolerance_.unit[i] = system.tolerance_unit(i);
    step_.t = t;
    step_.h = 0;
    step_.y_end = y;
  }

  double time() const { return step_.t + step_.h; }
  const State& state() const { return step_.y_end; }
  const State& slope() const { return step_.slope_end; }
  /// The step just taken: its ends, and its interior after `dense()`.
  const StepT& step() const { return step_; }
  StepT& dense() {
    step_.prepare_dense(field());
    return step_;
  }
  const Counters& counters() const { return counters_; }
  /// The field, or the state, has jumped (mode change, new reference): evaluate it anew.
  void refresh() { evaluated_ = false, step_.invalidate(); }
  void refresh(const State& y) { step_.y_end = y, refresh(); }
  /// Continues from another time and state with the present step length.
  void restart(double t, const State& y) { step_.t = t, step_.h = 0, refresh(y); }
  /// Bounds the next step, after an event that brings faster dynamics.
  void limit_next_step(double h) { h_next_ = std::min(h_next_, h); }

  /// One accepted step, at most to `t_stop`.
  Outcome step(double t_stop) {
    if (!evaluated_) {
      field()(time(), step_.y_end, step_.slope_end);
      system_.guards(time(), step_.y_end, step_.slope_end, end_);
      evaluated_ = true;
    }
    start_ = end_;
    if (const int i = violated_guard(); i >= 0) {
      ++counters_.events;
      if (++immediate_ > kMaxImmediateEvents) return {Status::kStuck, i, true};
      return {Status::kEvent, i, true};
    }
    step_.next();
    const double t = step_.t;
    if (!step_.slope.allFinite()) return restore(Status::kNotFinite);
    if (t >= t_stop) return restore(Status::kReached);

    bool to_stop = false, rejected = false;
    double factor = 1;
    for (;;) {
      to_stop = t + kStepControl.slack * h_next_ >= t_stop;
      step_.h = to_stop ? t_stop - t : h_next_;
      step_.advance(field());
      const double error = step_.error(tolerance_);
      if (error <= 1 && step_.slope_end.allFinite()) {
        factor = growth(error, rejected);
        break;
      }
      rejected = true;
      ++counters_.rejected;
      h_next_ = step_.h * (error > 1 && error < 1e10 ? std::max(kStepControl.min, growth(error, true))
                                                     : kStepControl.failed);  // also where the error is NaN
      if (h_next_ < 4 * std::numeric_limits<double>::epsilon() * std::max(std::abs(t), 1e-10))
        return restore(Status::kTooSmall);
    }
    ++counters_.steps;
    const double grown = std::min(step_.h * factor, options_.max_step);
    h_next_ = to_stop ? std::max(h_next_, grown) : grown;
    counters_.implicit += step_.implicit();
    system_.guards(time(), step_.y_end, step_.slope_end, end_);

    const Crossing c = first_crossing();
    if (c.guard < 0) {
      immediate_ = 0;
      h_next_ = step_.choose(h_next_);
      return {to_stop ? Status::kReached : Status::kStepped};
    }
    ++counters_.events;
    end_at(c);
    evaluated_ = false;
    immediate_ = step_.h > 0 ? 0 : immediate_ + 1;
    return {immediate_ > kMaxImmediateEvents ? Status::kStuck : Status::kEvent, c.guard};
  }

 private:
  struct Crossing {
    int guard = -1;
    double s = 2;  ///< where in the step, 0..1
  };
  /// The interface that a step uses: f, its Jacobian, and the number of position components.
  struct Field {
    static constexpr int kPositions = System::kPositions;
    const System& system;
    Counters& counters;
    void operator()(double t, const State& y, State& dy) const {
      ++counters.derivatives;
      system.derivative(t, y, dy);
    }
    template <class Matrix>
    void linearize(double t, const State& y, Matrix& jacobian, State& rate) const {
      ++counters.jacobians;
      system.linearize(t, y, jacobian, rate);
    }
  };
  Field field() { return {system_, counters_}; }
  Outcome restore(Status status) {
    step_.h = 0, step_.y_end = step_.y, step_.slope_end = step_.slope;
    return {status};
  }
  double growth(double error, bool after_rejection) const {
    const double f =
        error > 1e-12 ? kStepControl.safety * std::pow(float(error), -1.0F / float(step_.error_order() + 1)) : 10;
    return std::clamp(f, kStepControl.min, after_rejection ? 1.0 : kStepControl.max);
  }

  /// Number of guards in use now, the first ones.
  int guard_count() const {
    if constexpr (requires { system_.guards_used(); })
      return system_.guards_used();
    else
      return kGuards;
  }

  /// A guard that is at or below zero and falling where the step starts; -1 if none.
  int violated_guard() const {
    for (int i = 0, guards = guard_count(); i < guards; ++i)
      if (start_.value[i] <= 0 && start_.rate[i] < 0) return i;
    return -1;
  }

  /// True where a guard is positive with rate 0 at both ends, as an inactive one is: its cubic stays positive.
  bool is_constant(int i) const {
    return start_.rate[i] == 0 && end_.rate[i] == 0 && start_.value[i] > 0 && end_.value[i] > 0;
  }

  double guard_at(int i, double s) {
    Guards<kGuards> g;
    const State y = dense().at(s);
    system_.guards(step_.t + s * step_.h, y, step_.slope_end, g);  // only the value is used
    return g.value[i];
  }

  Node start_of(int i) const { return start_node(start_.value[i], start_.rate[i] * step_.h); }

  /// The earliest zero inside the step. A guard that falls monotonically is first located by its cubic, and refined on
  /// the dense output only if it may be the earliest; one that comes close to zero or leaves it is searched throughout.
  Crossing first_crossing() {
    Crossing first;
    std::bitset<kGuards> uncertain, falling;
    std::array<double, kGuards> guess{};
    double earliest = 2;
    const int guards = guard_count();
    for (int i = 0; i < guards; ++i) {
      if (is_constant(i)) continue;
      const Node a = start_of(i), b{1, end_.value[i], end_.rate[i] * step_.h};
      const double margin = 0.02 * (std::abs(a.d) + std::abs(b.d));
      if (bernstein_minimum(a, b) > (a.g > 0 ? margin : 0)) continue;
      if (a.g > margin && b.g < 0 && a.d < 0 && b.d < 0) {
        falling.set(std::size_t(i));
        guess[i] = root(a.s, a.g, b.s, b.g, [&](double x) { return cubic(a, b, x); });
        earliest = std::min(earliest, guess[i]);
      } else {
        uncertain.set(std::size_t(i));
      }
    }
    constexpr double kCubicError = 0.05;  // bound of the error of a zero by a cubic, in fractions of a step
    for (int i = 0; i < guards; ++i)
      if (falling[std::size_t(i)] && guess[i] <= earliest + kCubicError) {
        const double s = refined_zero(i, guess[i]);
        if (s < first.s) first = {i, s};
      }
    if (uncertain.any()) search_inside(uncertain, first);
    return first;
  }

  /// The zero of a falling guard on the dense output, close to that of its cubic.
  double refined_zero(int i, double guess) {
    const auto value = [&](double s) { return guard_at(i, s); };
    double at = value(guess);
    if (at == 0) return guess;
    constexpr double kWidening = 8;
    for (double w = 1e-3; w < 1; w *= kWidening) {
      const double other = at > 0 ? std::min(1.0, guess + w) : std::max(0.0, guess - w);
      const double there = other == 0 ? start_.value[i] : other == 1 ? end_.value[i] : value(other);
      if ((there > 0) != (at > 0))
        return at > 0 ? root(guess, at, other, there, value) : root(other, there, guess, at, value);
      guess = other, at = there;
    }
    return guess;
  }

  /// Searches the dense output in four parts, for guards that come close to zero or leave it.
  void search_inside(const std::bitset<kGuards>& uncertain, Crossing& first) {
    constexpr int kParts = 4;
    const int guards = guard_count();
    Guards<kGuards> left = start_, right;
    for (int q = 1; q <= kParts; ++q) {
      const double sa = (q - 1.0) / kParts, sb = double(q) / kParts;
      if (first.s <= sa) return;
      if (q == kParts) {
        right = end_;
      } else {
        const State y = dense().at(sb);
        const double t = step_.t + sb * step_.h;
        State dy;
        field()(t, y, dy);
        system_.guards(t, y, dy, right);
      }
      for (int i = 0; i < guards; ++i)
        if (uncertain[std::size_t(i)]) {
          const Node a = q == 1 ? start_of(i) : Node{sa, left.value[i], left.rate[i] * step_.h},
                     b{sb, right.value[i], right.rate[i] * step_.h};
          const double s = zero_between(a, b, [&](double x) { return guard_at(i, x); });
          if (s < first.s) first = {i, s};
        }
      left = right;
    }
  }

  /// Retakes the step so that it ends on the zero of `c.guard`: first with the length that the dense output gives,
  /// then, as long as the zero is farther than kMaxShift of that length from its end, with a better one (Newton). A
  /// zero at the start is an event of length zero; a guard that only grazes zero is met at its minimum.
  void end_at(const Crossing& c) {
    constexpr double kMaxShift = 1e-4;  // beyond it curvature matters
    constexpr int kMaxRetakes = 8;
    const double whole = step_.h;
    double h = c.s * whole;
    for (int i = 1;; ++i) {
      if (!(h > 0)) {
        restore(Status::kEvent);
        return;
      }
      step_.h = h;
      step_.advance(field());
      system_.guards(time(), step_.y_end, step_.slope_end, end_);
      const double g = end_.value[c.guard], rate = end_.rate[c.guard];
      if (g == 0 || !(rate < 0)) return;
      const double shift = -g / rate;
      if (std::abs(shift) <= kMaxShift * h) {
        step_.move_end(shift);
        field()(time(), step_.y_end, step_.slope_end);
        return;
      }
      if (i == kMaxRetakes || std::abs(shift) > 0.2 * whole) return;
      h = std::min(h + shift, whole);
    }
  }

  const System& system_;
  Options options_;
  Tolerance<System::kControlled> tolerance_;
  StepT step_;
  Guards<kGuards> start_, end_;
  Counters counters_;
  double h_next_;
  bool evaluated_ = false;
  int immediate_ = 0;
};

}  // namespace ukemi::integrate

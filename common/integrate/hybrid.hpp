// The adaptive driver for systems that are smooth between events.
//
// A system holds its discrete mode (which points touch, which limit acts) and offers guards: functions of the state
// that are positive while the mode is right. The driver integrates the smooth field of the present mode, shortens the
// step that would end beyond a guard's zero, and stops there; the owner changes the mode and goes on.
//
// Rules at and after an event:
//   - a step never crosses a guard's zero: the step is retaken with the length at which the guard vanishes (Newton on
//   the
//     length, each iterate a full step of the method), so that the event is located to rounding of the discrete
//     solution;
//   - the owner flips the guard's sign in `cross`; a guard that starts within rounding of zero and rises is left alone
//     (no sticking), one that starts at or below zero and falls is an event of length zero (simultaneous touchdowns);
//   - a step also looks inside itself: the cubic through both ends' values and rates is bounded by its Bernstein
//     coefficients, and where that comes near zero the dense output is searched on four parts (no missed grazing);
//   - more than kMaxImmediate events at one instant end the run as kStuck.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/integrate/runge_kutta.hpp"

namespace ukemi::integrate {

/// Guards of a mode: positive while the mode holds. An inactive guard has value 1 and rate 0; `guards()` sets every one
/// afresh.
template <int N>
struct Guards {
  std::array<double, N> value;
  std::array<double, N> rate;
  Guards() { value.fill(1), rate.fill(0); }
  void set(int i, double v, double r) { value[i] = v, rate[i] = r; }
};

enum class Status {
  kStepped,    ///< the step was taken; there may be more
  kReached,    ///< the step ended at the stop time
  kEvent,      ///< the step ended on a guard's zero (or had length zero: `immediate`)
  kTooSmall,   ///< the error control asks for a step below the resolution of time
  kNotFinite,  ///< the field is not finite where the step starts
  kStuck,      ///< too many events at one instant
};

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

/// Work done so far.
struct Counters {
  long steps = 0, rejected = 0, derivatives = 0, events = 0;
};

/// What a system offers. `derivative` is smooth for the present mode; `tolerance_unit(i)` is the size of component i
/// below which it need not be relatively exact; only the first kControlled components steer the step.
template <class S>
concept HybridSystem = requires(const S& s, double t, const typename S::State& y, Guards<S::kGuards>& g) {
  { s.derivative(t, y) } -> std::same_as<typename S::State>;
  {s.guards(t, y, y, g)};
  { s.tolerance_unit(0) } -> std::convertible_to<double>;
  S::kControlled;
};

/// Integrates `System` from event to event. The system is referenced, not owned; after an event change its mode, then
/// go on.
template <class Tableau, class System>
class Integrator {
 public:
  static constexpr int kGuards = System::kGuards, kMaxImmediate = 64;
  using State = typename System::State;
  using Scalar = typename State::Scalar;
  using StepT = Step<Tableau, Scalar, State::RowsAtCompileTime>;

  Integrator(const System& system, double t, const State& y, const Options& options)
      : system_(system), options_(options), h_next_(options.first_step) {
    step_.t = t;
    step_.h = 0;
    step_.y_end = y;
  }

  double time() const { return step_.t + step_.h; }
  const State& state() const { return step_.y_end; }
  const State& slope() const { return step_.slope_end(); }
  /// The step just taken: its ends, and its interior after `dense()`.
  const StepT& step() const { return step_; }
  StepT& dense() {
    step_.prepare_dense(field());
    return step_;
  }
  const Counters& counters() const { return counters_; }
  /// The field, or the state, has jumped (mode change, new reference): evaluate it afresh.
  void refresh() { fresh_ = false; }
  void refresh(const State& y) { step_.y_end = y, fresh_ = false; }
  /// Bounds the next step, after an event that brings faster dynamics.
  void limit_next_step(double h) { h_next_ = std::min(h_next_, h); }

  /// One accepted step, at most to `t_stop`.
  Outcome step(double t_stop) {
    if (!fresh_) {
      step_.k[StepT::kLast] = field()(time(), step_.y_end);
      system_.guards(time(), step_.y_end, step_.slope_end(), end_);
      fresh_ = true;
    }
    start_ = end_;
    if (const int i = violated(); i >= 0) {
      ++counters_.events;
      if (++immediate_ > kMaxImmediate) return {Status::kStuck, i, true};
      return {Status::kEvent, i, true};
    }
    const double t = time();
    step_.t = t;
    step_.y = step_.y_end;
    step_.k[0] = step_.k[StepT::kLast];
    if (!step_.k[0].allFinite()) return restore(Status::kNotFinite);
    if (t >= t_stop) return restore(Status::kReached);

    bool truncated = false, rejected = false;
    double factor = 1;
    for (;;) {
      truncated = t + 1.001 * h_next_ >= t_stop;
      step_.h = truncated ? t_stop - t : h_next_;
      advance();
      const double error = step_.error(System::kControlled, [&](int i, double a, double b) {
        return options_.accuracy * (system_.tolerance_unit(i) + std::max(std::abs(a), std::abs(b)));
      });
      if (error <= 1) {
        factor = growth(error, rejected);
        break;
      }
      rejected = true;
      ++counters_.rejected;
      h_next_ = step_.h * (error < 1e10 ? std::max(0.2, growth(error, true)) : 0.1);  // also where the error is NaN
      if (h_next_ < 4 * std::numeric_limits<double>::epsilon() * std::max(std::abs(t), 1e-10))
        return restore(Status::kTooSmall);
    }
    const double grown = std::min(step_.h * factor, options_.max_step);
    h_next_ = truncated ? std::max(h_next_, grown) : grown;
    system_.guards(time(), step_.y_end, step_.slope_end(), end_);

    int event = -1;
    for (int round = 0; round < kGuards; ++round) {
      const Crossing c = first_crossing(event);
      if (c.guard < 0) break;
      event = c.guard;
      shorten(c);
    }
    ++counters_.steps;
    if (step_.h > 0)
      immediate_ = 0;
    else if (++immediate_ > kMaxImmediate)
      return {Status::kStuck, event};
    if (event >= 0) {
      ++counters_.events;
      return {Status::kEvent, event, false};
    }
    return {truncated ? Status::kReached : Status::kStepped};
  }

 private:
  struct Crossing {
    int guard = -1;
    double s = 2;  ///< where in the step, 0..1
  };
  /// One end of a part of the step as a guard sees it: place, value, derivative with respect to the place.
  struct Node {
    double s, g, d;
  };

  auto field() {
    return [this](double t, const State& y) {
      ++counters_.derivatives;
      return system_.derivative(t, y);
    };
  }
  void advance() { step_.advance(field()); }
  Outcome restore(Status status) {
    step_.h = 0, step_.y_end = step_.y;
    return {status};
  }
  static double growth(double error, bool after_rejection) {
    constexpr double kSafety = 0.9, kExponent = -1.0 / (Tableau::kErrorOrder + 1);
    const double f = error > 1e-12 ? kSafety * std::pow(error, kExponent) : 10;
    return std::clamp(f, 0.2, after_rejection ? 1.0 : 8.0);
  }

  /// A guard that is at or below zero and falling where the step starts; -1 if none.
  int violated() const {
    for (int i = 0; i < kGuards; ++i)
      if (start_.value[i] <= 0 && start_.rate[i] < 0) return i;
    return -1;
  }

  double guard_at(int i, double s) {
    Guards<kGuards> g;
    const State y = dense().at(s);
    system_.guards(step_.t + s * step_.h, y, step_.slope_end(), g);  // only the value is used
    return g.value[i];
  }

  /// Where the cubic through two nodes first falls to zero, given that it does; and the place of its lowest interior
  /// point.
  static double cubic(const Node& a, const Node& b, double s) {
    const double w = b.s - a.s, x = (s - a.s) / w, y = 1 - x;
    return y * y * ((1 + 2 * x) * a.g + x * w * a.d) + x * x * ((3 - 2 * x) * b.g - y * w * b.d);
  }
  static double cubic_minimum(const Node& a, const Node& b) {
    const double w = b.s - a.s, c1 = w * a.d, c2 = 3 * (b.g - a.g) - w * (2 * a.d + b.d),
                 c3 = 2 * (a.g - b.g) + w * (a.d + b.d);
    const double disc = c2 * c2 - 3 * c1 * c3;  // root of c1 + 2 c2 x + 3 c3 x^2 with positive curvature
    if (disc <= 0) return -1;
    const double root = std::sqrt(disc), x = c2 > 0 ? -c1 / (c2 + root) : (c3 != 0 ? (root - c2) / (3 * c3) : -1);
    return x > 0 && x < 1 ? a.s + x * w : -1;
  }
  /// A lower bound of that cubic; where it starts on zero, of its part beyond the start.
  static double bernstein_minimum(const Node& a, const Node& b) {
    const double w = (b.s - a.s) / 3, inner = std::min(b.g, std::min(a.g + w * a.d, b.g - w * b.d));
    return a.g > 0 ? std::min(a.g, inner) : inner;
  }
  /// Bisection with secant steps (Illinois) of a function that is positive at a and negative at b.
  template <class F>
  static double root(double a, double fa, double b, double fb, F&& f) {
    for (int i = 0, side = 0; i < 80 && b - a > 1e-15; ++i) {
      double m = (a * fb - b * fa) / (fb - fa);
      if (!(m > a && m < b)) m = 0.5 * (a + b);
      const double fm = f(m);
      if (fm == 0) return m;
      if (fm < 0) {
        b = m, fb = fm;
        if (side == -1) fa *= 0.5;
        side = -1;
      } else {
        a = m, fa = fm;
        if (side == 1) fb *= 0.5;
        side = 1;
      }
    }
    return b;
  }

  /// The earliest zero inside the step, guessed on cubics; `known` is the guard whose zero the step already ends on.
  Crossing first_crossing(int known) {
    Crossing first;
    unsigned near = 0;
    for (int i = 0; i < kGuards; ++i) {
      if (i == known) continue;
      const Node a{0, std::max(start_.value[i], 0.0), start_.rate[i] * step_.h},
          b{1, end_.value[i], end_.rate[i] * step_.h};
      const double margin = 0.02 * (std::abs(a.d) + std::abs(b.d));
      if (bernstein_minimum(a, b) > (a.g > 0 ? margin : 0)) continue;
      const bool plain = a.g > margin && b.g < 0 && a.d < 0 && b.d < 0;
      if (plain) {
        const double s = root(a.s, a.g, b.s, b.g, [&](double x) { return cubic(a, b, x); });
        if (s < first.s) first = {i, s};
      } else {
        near |= 1u << i;
      }
    }
    if (near != 0) search_inside(near, first);
    return first;
  }

  /// The same on the dense output, in four parts, for guards that come near zero or leave it.
  void search_inside(unsigned near, Crossing& first) {
    constexpr int kParts = 4;
    Guards<kGuards> left = start_, right;
    for (int q = 1; q <= kParts; ++q) {
      const double sa = (q - 1.0) / kParts, sb = double(q) / kParts;
      if (first.s <= sa) return;
      if (q == kParts) {
        right = end_;
      } else {
        const State y = dense().at(sb);
        const double t = step_.t + sb * step_.h;
        system_.guards(t, y, field()(t, y), right);
      }
      for (int i = 0; i < kGuards; ++i)
        if (near >> i & 1u) {
          const Node a{sa, q == 1 ? std::max(left.value[i], 0.0) : left.value[i], left.rate[i] * step_.h},
              b{sb, right.value[i], right.rate[i] * step_.h};
          const double s = zero_between(i, a, b);
          if (s < first.s) first = {i, s};
        }
      left = right;
    }
  }

  double zero_between(int i, const Node& a, const Node& b) {
    constexpr double kNone = 2;
    if (b.g >= 0 && bernstein_minimum(a, b) > 0) return kNone;
    const auto value = [&](double s) { return guard_at(i, s); };
    double lower = a.s, at_lower = a.g, upper = b.s, at_upper = b.g;
    if (b.g >= 0) {  // both ends are above: is there a dip between them?
      upper = cubic_minimum(a, b);
      if (upper < 0 || (at_upper = value(upper)) >= 0) return kNone;
    }
    if (a.g <= 0) {  // the part starts on the zero that was just left: begin where the guard has risen
      const double w = upper - a.s;
      for (double x = 0.5; x > 1e-6; x *= 0.5)
        if ((at_lower = value(a.s + x * w)) > 0) {
          lower = a.s + x * w;
          break;
        }
      if (at_lower <= 0) return a.s;
    }
    return root(lower, at_lower, upper, at_upper, value);
  }

  /// Retakes the step so that it ends on the zero of `c.guard`.
  void shorten(const Crossing& c) {
    const double whole = step_.h,
                 resolution = 2 * std::numeric_limits<double>::epsilon() * std::max(std::abs(step_.t), whole);
    step_.h = c.s * whole;
    for (int i = 0;; ++i) {
      advance();
      system_.guards(time(), step_.y_end, step_.slope_end(), end_);
      const double g = end_.value[c.guard], rate = end_.rate[c.guard];
      if (i == 6 || g == 0 || rate >= 0) break;
      const double shift = -g / rate;
      if (std::abs(shift) <= resolution || std::abs(shift) > 0.2 * whole) break;
      step_.h = std::clamp(step_.h + shift, 0.0, whole);
    }
  }

  const System& system_;
  Options options_;
  StepT step_;
  Guards<kGuards> start_, end_;
  Counters counters_;
  double h_next_;
  bool fresh_ = false;
  int immediate_ = 0;
};

}  // namespace ukemi::integrate

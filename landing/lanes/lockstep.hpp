// The lockstep of landings, one in each lane of the machine's registers: every lane attempts a step of its own length
// at the same time. Included by the files of the instruction sets alone, which define UKEMI_BATCH_TARGET: a stage and
// all that is inlined into it is compiled for that set. What is not inlined is compiled for the baseline, so nothing
// here can end up, through the linker, in a program for a lesser machine; and packs are passed in memory, so the two
// understand each other.
//
// The rules at and after events are those of hybrid.hpp, made cheaper for accuracies of 1e-7 and looser: a zero is
// placed by the cubic through the guard at both ends of the step, the step is retaken up to there, and what is left is
// made up along the field. What only some lanes need (events, the ends of landings) is worked out lane by lane in
// doubles, with the very functions of the scalar path.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/integrate/guards.hpp"
#include "common/integrate/hybrid.hpp"
#include "common/integrate/runge_kutta.hpp"
#include "common/integrate/step_control.hpp"
#include "common/integrate/tableaus.hpp"
#include "common/pack.hpp"
#include "landing/run/simulate.hpp"

/// A piece of the driver for one instruction set: called, not inlined, with everything below it inside.
#define UKEMI_BATCH_STAGE [[gnu::noinline]] UKEMI_FLATTEN UKEMI_BATCH_TARGET

namespace ukemi::landing {

/// `Landing` defines what falls:
///   load(i)              takes the next landing into a lane, by begin(), or leaves it empty
///   cross(i, guard)      into the mode beyond a guard; false where the landing ends there
///   reached(i)           the step has ended at stop_: how the landing ended, if it did
///   finish(i, end)       the landing of a lane is over; takes the next
///   peak_moved(i)        its largest value has just become larger
///   longest_step()       of all lanes [s]
///   stepped()            all accepted steps have ended
///   breaking(where), resting(where), beyond(where)  lanes of those that break a limit; that may end; whose landing
///                        is worse than is asked for
///   peak_square(s, y, dy)  what is largest, of all lanes
///   start_beside(where), look_beside()  of what else is followed, by follow_start and follow: where lanes start
///                        afresh; in the accepted steps
template <class Landing, class System, int W>
class Lockstep {
 protected:
  using T = Pack<W>;
  using M = Mask<W>;
  using State = typename System::State;
  using Node = integrate::Node;
  static constexpr int kGuards = System::kGuards, kStates = System::kStates;
  static constexpr integrate::StepControl kControl{};

  Lockstep(const System& system, double accuracy, long max_steps)
      : system_(system), accuracy_(accuracy), max_steps_(max_steps) {}

  /// Until every lane is without work, or the source is over.
  template <class Source>
  void run_all(Source& source) {
    for (int i = 0; i < W; ++i) landing().load(i);
    constexpr int kAsked = 32;  // steps between two questions whether it is over: some tens of microseconds
    for (int n = 1; any(active_) && !(n % kAsked == 0 && source.over()); ++n) {
      start_afresh();
      attempt();
      judge();
      look();
      move_on();
    }
  }

  // --- one lane, in doubles ---

  /// A landing begins in a lane, its system, stop_ and abandon_square_ already set.
  template <class Values, class Unit>
  void begin(int i, double t, const Values& y, double first_step, double square, Unit&& unit) {
    for (int k = 0; k < kStates; ++k) step_.y[k].set(i, y[k]), unit_[k].set(i, unit(k));
    step_.t.set(i, t), h_next_.set(i, first_step);
    peak_.square.set(i, square), peak_.t.set(i, 0), steps_.set(i, 0);
    active_.set(i, true), stale_.set(i, true), cut_.set(i, false), rejected_.set(i, false);
    t_event_[i] = -1, immediate_[i] = 0, cuts_[i] = 0;
    guards_ = std::max(guards_, system_.guards_used());
  }
  /// A lane without a landing, that costs its neighbours nothing: angles that are no numbers, or large, do.
  void empty(int i) {
    active_.set(i, false), stale_.set(i, false);
    step_.h.set(i, 0), h_next_.set(i, 0), cut_.set(i, false);
    for (int k = 0; k < kStates; ++k) step_.y[k].set(i, 0), step_.slope[k].set(i, 0), unit_[k].set(i, 1);
  }

  /// A zero of a guard inside a step.
  struct Zero {
    int guard = -1;
    double s = 2;  ///< where in the step, 0..1
  };
  static constexpr double kPlaced = 1e-5;  ///< how exactly, in parts of a step; the rest is made up along the field
  /// Whether a step is so short that a guard's values may be rounding beside its rates.
  bool brief(int i) const {
    constexpr double kInstant = 1e-9;  // [s]: what accuracies of lanes do not tell apart
    return step_.h[i] <= kInstant;
  }
  /// A guard that begins within rounding below zero and rises has no zero in a step too short to lift it out.
  bool rises(int g, int i) const {
    return start_.rate[g][i] > 0 && end_.rate[g][i] > 0 &&
           (brief(i) || (start_.value[g][i] <= 0 && end_.value[g][i] >= 2 * start_.value[g][i]));
  }
  /// The earliest zero of a guard's cubic in the lane's step.
  Zero first_zero(int i) const {
    Zero first;
    for (int g = 0; g < guard_count(); ++g) {
      if (!near_[g][i] || rises(g, i)) continue;
      const Node a = integrate::start_node(start_.value[g][i], start_.rate[g][i] * step_.h[i]),
                 b{1, end_.value[g][i], end_.rate[g][i] * step_.h[i]};
      const double s = integrate::zero_between(
          a, b, [&](double x) { return cubic(a, b, x); }, kPlaced);
      if (s < first.s) first = {g, s};
    }
    return first;
  }

  /// Times nearer than this are one [s].
  static double resolution(double t) { return 4 * std::numeric_limits<double>::epsilon() * std::max(t, 1e-10); }

  enum class StepEnd { kPlain, kCut, kEvent };
  /// What a step with a guard near its zero is: an event if the zero is within reach of its end, else cut there.
  [[gnu::noinline]] StepEnd end_of_step(int i) {
    constexpr double kReach = 3e-4;  // of the step, however short it was cut: made up along the field
    constexpr int kMaxCuts = 12;
    if (!cut_[i]) cuts_[i] = 0;
    if (cut_[i] && step_.h[i] == 0) return StepEnd::kEvent;  // cut to nothing: the guard falls from where it starts
    Zero c = first_zero(i);
    if (c.guard < 0 && cut_[i]) c = {target_[i], 1};  // the cubic placed it a little early
    if (c.guard < 0) return StepEnd::kPlain;
    const double g = end_.value[c.guard][i], rate = end_.rate[c.guard][i], shift = -g / rate;
    const double reach = std::max(kReach * step_.h[i], resolution(step_.t[i]));
    target_[i] = c.guard;
    if (rate < 0 && (std::abs(shift) <= reach || brief(i) || (cuts_[i] >= kMaxCuts && g <= 0))) {
      shift_.set(i, std::clamp(shift, -step_.h[i], brief(i) ? std::max(reach, step_.h[i]) : std::abs(shift)));
      return StepEnd::kEvent;
    }
    if (c.s >= 1 || cuts_[i] >= kMaxCuts) return StepEnd::kPlain;
    ++cuts_[i];
    cut_h_.set(i, c.s * step_.h[i]);
    return StepEnd::kCut;
  }

  // --- every lane at once ---

  /// The largest square of something, when it was, and the square at the start of the step.
  struct Largest {
    T square{0.0}, t{0.0}, start{0.0};
  };
  UKEMI_INLINE void consider(Largest& x, const M& where, const T& q, const T& t) {
    const M higher = where & (q > x.square);
    if (!any(higher)) return;
    assign(x.square, higher, q), assign(x.t, higher, t);
    if (&x != &peak_) return;
    for (int i = 0; i < W; ++i)
      if (higher[i]) landing().peak_moved(i);
  }
  /// Behind an event, or at the start.
  UKEMI_INLINE void follow_start(Largest& x, const M& where, const T& q) {
    assign(x.start, where, q);
    consider(x, where, q, step_.t);
  }

  /// The field where it has jumped, and the events that take no time.
  UKEMI_BATCH_STAGE void start_afresh() {
    while (any(stale_)) {
      State dy;
      typename System::GuardValues g;
      field(step_.t, step_.y, dy);
      guards(step_.t, step_.y, dy, g);
      M violated(false);
      for (int k = 0; k < kStates; ++k) assign(step_.slope[k], stale_, dy[k]);
      for (int k = 0; k < guard_count(); ++k) {
        assign(start_.value[k], stale_, g.value[k]), assign(start_.rate[k], stale_, g.rate[k]);
        violated |= stale_ & (g.value[k] <= T(0.0)) & (g.rate[k] < T(0.0));
      }
      const M settled = stale_ & !violated;
      follow_start(peak_, settled, Landing::peak_square(system_, step_.y, dy));
      landing().start_beside(settled);
      stale_ = M(false);
      if (!any(violated)) return;
      for (int i = 0; i < W; ++i)
        if (violated[i]) take_immediate(i);
    }
  }
  [[gnu::noinline]] void take_immediate(int i) {
    if (step_.t[i] != t_event_[i]) t_event_[i] = step_.t[i], immediate_[i] = 0;
    if (++immediate_[i] > integrate::kMostImmediate) return landing().finish(i, End::kFailed);
    for (int k = 0; k < guard_count(); ++k)
      if (start_.value[k][i] <= 0 && start_.rate[k][i] < 0) {
        if (!landing().cross(i, k)) landing().finish(i, End::kBroken);
        return;
      }
  }

  UKEMI_BATCH_STAGE void attempt() {
    last_ = step_.t + T(kControl.slack) * h_next_ >= stop_;
    const T h = select(last_, T(stop_ - step_.t), h_next_);
    step_.h = select(cut_, cut_h_, select(active_, h, T(0.0)));
    last_ &= !cut_;
    step_.advance([this](const T& t, const State& y, State& dy) UKEMI_INLINE_LAMBDA { field(t, y, dy); });
  }
  UKEMI_BATCH_STAGE void field(const T& t, const State& y, State& dy) const { system_.derivative(t, y, dy); }
  UKEMI_BATCH_STAGE void guards(const T& t, const State& y, const State& dy, typename System::GuardValues& g) const {
    system_.guards(t, y, dy, g);
  }

  /// Accepted, rejected, cut short or ended by an event.
  UKEMI_BATCH_STAGE void judge() {
    const State e = step_.error_rate();
    T sum(0.0), check(0.0);
    for (int k = 0; k < kStates; ++k) {
      const T size = unit_[k] + max(abs(step_.y[k]), abs(step_.y_end[k])), r = e[k] / size;
      sum += r * r;
      check += step_.slope_end[k];
    }
    const T error2 = sum * step_.h * step_.h * T(1 / (double(kStates) * accuracy_ * accuracy_));
    accepted_ = active_ & (error2 <= T(1.0)) & finite(check);
    const T factor =
        select(finite(error2), T(kControl.safety) * inverse_tenth_root(max(error2, T(1e-24))), T(kControl.broken));
    const T growth = max(T(kControl.least), min(factor, select(rejected_ | !accepted_, T(1.0), T(kControl.most))));
    T next = min(step_.h * growth, T(kMaxStep));
    next = min(next, landing().longest_step());
    const M fresh = active_ & !(cut_ & accepted_);
    assign(h_next_, fresh, select(accepted_ & last_, max(next, h_next_), next));
    rejected_ = active_ & !accepted_;

    guards(step_.t + step_.h, step_.y_end, step_.slope_end, end_);
    M near = cut_;
    for (int k = 0; k < guard_count(); ++k) {
      const T third(1.0 / 3), a = start_.value[k], b = end_.value[k];
      const T inner = min(a + step_.h * third * start_.rate[k], b - step_.h * third * end_.rate[k]);
      near |= near_[k] = (b <= T(0.0)) | (inner <= T(0.0));
    }
    near &= accepted_;
    event_ = M(false), shift_ = T(0.0);
    M cut(false);
    if (any(near))
      for (int i = 0; i < W; ++i)
        if (near[i]) {
          const StepEnd how = end_of_step(i);
          event_.set(i, how == StepEnd::kEvent), cut.set(i, how == StepEnd::kCut);
        }
    // A cut step without an event: the cubic of so long a step says nothing of what lies ahead.
    constexpr double kAfterCut = 8;  // times the cut length, at most
    const M missed = cut_ & accepted_ & !event_ & !cut;
    assign(h_next_, missed, min(h_next_, T(kAfterCut) * step_.h));
    cut_ = cut;
    accepted_ &= !cut;
  }

  UKEMI_BATCH_STAGE void look() {
    follow(peak_, [this](const T&, const State& y, const State& dy)
                      UKEMI_INLINE_LAMBDA { return Landing::peak_square(system_, y, dy); });
    landing().look_beside();
  }
  /// The largest value at the end of the accepted steps, and inside those that could hold a higher one.
  /// square_of(t, y, dy): of all lanes.
  template <class SquareOf>
  UKEMI_INLINE void follow(Largest& x, SquareOf&& square_of) {
    const T q_rate = square_of(T(step_.t + step_.h), step_.y_end, step_.slope_end);
    const T q_end = select(event_, q_rate + (q_rate - x.start) * shift_ / max(step_.h, T(1e-12)), q_rate);
    consider(x, accepted_, q_end, step_.t + step_.h + shift_);
    constexpr double kInside = 0.5, kNear = 0.9;  // as squares; see peak_tracker.hpp
    const M inside = accepted_ & (max(x.start, q_end) > T(kInside) * x.square);
    if (any(inside)) {
      const auto at = [&](const T& s) UKEMI_INLINE_LAMBDA {
        const State y = step_.at(s);
        State dy;
        const T t = step_.t + s * step_.h;
        field(t, y, dy);
        return square_of(t, y, dy);
      };
      T a(0.0), b(0.5), c(1.0), qa = x.start, qb = at(b), qc = q_rate;
      consider(x, inside, qb, step_.t + b * step_.h);
      for (int n = 0; n < 3; ++n) {
        const T u = (qb - qa) / (b - a), v = (qc - qb) / (c - b), bend = (v - u) / (c - a);
        const T top = T(0.5) * (a + b - u / bend);
        const M open = inside & (bend < T(0.0)) & (top > a) & (top < c) & (abs(top - b) > T(1e-4)) &
                       (max(qa, max(qb, qc)) > T(kNear) * x.square);
        if (!any(open)) break;
        const T s = select(open, top, b), q = at(s);
        consider(x, open, q, step_.t + s * step_.h);
        const M left = (s < b), better = (q > qb);
        assign(a, open & (left & (!better)), s), assign(qa, open & (left & (!better)), q);
        assign(c, open & ((!left) & (!better)), s), assign(qc, open & ((!left) & (!better)), q);
        assign(c, open & left & better, b), assign(qc, open & left & better, qb);
        assign(a, open & (!left) & better, b), assign(qa, open & (!left) & better, qb);
        assign(b, open & better, s), assign(qb, open & better, q);
      }
    }
    assign(x.start, accepted_, q_end);
  }

  /// Begins the next step of every lane where this one ended, or the next landing.
  UKEMI_BATCH_STAGE void move_on() {
    const T h = step_.h + shift_;
    assign(step_.t, accepted_, step_.t + h);
    for (int k = 0; k < kStates; ++k) {
      assign(step_.y[k], accepted_, step_.y_end[k] + shift_ * step_.slope_end[k]);
      assign(step_.slope[k], accepted_, step_.slope_end[k]);
    }
    for (int k = 0; k < guard_count(); ++k)
      assign(start_.value[k], accepted_, end_.value[k]), assign(start_.rate[k], accepted_, end_.rate[k]);

    const M plain = accepted_ & !event_, at_deadline = plain & last_;
    std::array<std::optional<End>, W> end{};
    if (any(at_deadline))
      for (int i = 0; i < W; ++i)
        if (at_deadline[i]) end[i] = landing().reached(i);
    landing().stepped();
    const M abandoned = landing().beyond(accepted_), broken = landing().breaking(accepted_),
            rest = landing().resting(plain);
    const M tiny = rejected_ & (h_next_ < T(4 * std::numeric_limits<double>::epsilon()) * max(step_.t, T(1e-10)));
    steps_ += select(active_, T(1.0), T(0.0));
    const M failed = tiny | (active_ & (steps_ > T(double(max_steps_))));
    if (!any(event_ | at_deadline | abandoned | broken | rest | failed)) return;
    for (int i = 0; i < W; ++i) {
      if (!active_[i]) continue;
      if (failed[i])
        landing().finish(i, End::kFailed);
      else if (abandoned[i])
        landing().finish(i, End::kAbandoned);
      else if (broken[i])
        landing().finish(i, End::kBroken);
      else if (rest[i])
        landing().finish(i, End::kRest);
      else if (end[i])
        landing().finish(i, *end[i]);
      else if (event_[i] && !landing().cross(i, target_[i]))
        landing().finish(i, End::kBroken);
    }
  }

  static constexpr double kMaxStep = 0.1;  ///< [s]

  System system_;
  integrate::Step<integrate::DormandPrince54, T, kStates> step_;
  typename System::GuardValues start_, end_;
  T h_next_{0.0}, cut_h_{0.0}, shift_{0.0}, stop_{0.0}, abandon_square_{0.0};
  Largest peak_;
  T steps_{0.0};
  M active_, stale_, cut_, rejected_, accepted_, event_, last_;
  std::array<T, kStates> unit_;
  std::array<M, kGuards> near_;  ///< guards that may have a zero in the attempted step
  std::array<int, W> target_{}, immediate_{}, cuts_{};
  int guards_ = 0;                   ///< see guard_count
  std::array<double, W> t_event_{};  ///< the instant that immediate_ counts at

 private:
  Landing& landing() { return static_cast<Landing&>(*this); }
  /// The first so many are in use in some lane; known to the compiler where nothing can rub.
  UKEMI_INLINE int guard_count() const {
    if constexpr (Landing::kMayRub)
      return guards_;
    else
      return kGuards;
  }

  const double accuracy_;
  const long max_steps_;
};

}  // namespace ukemi::landing

// Integration of landings in lockstep, one in each lane of the SIMD registers: all lanes attempt a step at the same
// time, each of its own length. Included only by the files of the instruction sets, which define UKEMI_BATCH_TARGET: a
// stage and all that is inlined into it is compiled for that set. Other functions are compiled for the baseline, so
// that the linker cannot put wider instructions into programs for smaller machines; packs are passed in memory, so both
// have the same calling convention.
//
// Events are handled as in hybrid.hpp, but cheaper, for accuracies of 1e-7 and looser: a zero is located by the cubic
// Hermite interpolant of the guard over the step, the step is repeated up to there, and the remaining error in time is
// corrected along the field. What only some lanes need (events, ends of landings) is computed lane by lane in doubles,
// by the functions of the scalar path.
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

/// A stage of the integrator for one instruction set: not inlined itself, with all its callees inlined.
#define UKEMI_BATCH_STAGE [[gnu::noinline]] UKEMI_FLATTEN UKEMI_BATCH_TARGET

namespace ukemi::landing {

/// CRTP base; `Landing` provides
///   load(i)              starts the next landing in lane i by begin(), or clears the lane
///   cross(i, guard)      changes the mode at a guard; false if the landing ends there
///   reached(i)           handles the deadline stop_ at the end of a step; returns how the landing ended, if it did
///   finish(i, end)       reports the landing of lane i and starts the next
///   peak_raised(i)       called when the peak of lane i has increased
///   longest_step()       maximum steps of all lanes [s]
///   given_up()           the lanes whose landings fail here, and may succeed in the scalar path
///   stepped()            called after accepted steps
///   breaking(where), resting(where), abandoned(where)  the lanes among `where` that break a limit; that are at rest;
///                        whose peak exceeds abandon_above
///   peak_square(s, y, dy)  |acceleration|^2 of all lanes
///   start_other_maxima(where), track_other_maxima()  track further maxima by track_start in restarted lanes, and by
///                        track in accepted steps
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

  /// Runs until no lane has work or the source is over.
  template <class Source>
  void run_all(Source& source) {
    for (int i = 0; i < W; ++i) landing().load(i);
    constexpr int kPollInterval = 32;  // steps between calls of over(): some tens of microseconds
    for (int n = 1; any(active_) && !(n % kPollInterval == 0 && source.over()); ++n) {
      restart_lanes();
      attempt();
      control_steps();
      track_maxima();
      finish_step();
    }
  }

  // --- one lane, in doubles ---

  /// Starts a landing in lane i, whose system, stop_ and abandon_square_ are set by the caller.
  template <class Values, class Unit>
  void begin(int i, double t, const Values& y, double first_step, double square, Unit&& unit) {
    for (int k = 0; k < kStates; ++k) step_.y[k].set(i, y[k]), unit_[k].set(i, unit(k));
    step_.t.set(i, t), h_next_.set(i, first_step);
    peak_.square.set(i, square), peak_.t.set(i, 0), steps_.set(i, 0);
    active_.set(i, true), stale_.set(i, true), cut_.set(i, false), rejected_.set(i, false);
    t_event_[i] = -1, immediate_count_[i] = 0, cut_count_[i] = 0;
    guards_ = std::max(guards_, system_.guards_used());
  }
  /// Clears a lane without a landing: NaN or large angles would slow down the other lanes.
  void clear_lane(int i) {
    active_.set(i, false), stale_.set(i, false);
    step_.h.set(i, 0), h_next_.set(i, 0), cut_.set(i, false);
    for (int k = 0; k < kStates; ++k) step_.y[k].set(i, 0), step_.slope[k].set(i, 0), unit_[k].set(i, 1);
  }

  /// A zero of a guard in a step.
  struct Zero {
    int guard = -1;
    double s = 2;  ///< place in the step, 0..1
  };
  static constexpr double kZeroTolerance = 1e-5;  ///< of a zero, in steps; the rest is corrected along the field
  /// Whether a step is so short that values of guards may be rounding errors.
  bool is_instant(int i) const {
    constexpr double kInstant = 1e-9;  // below the resolution of the lanes' accuracies [s]
    return step_.h[i] <= kInstant;
  }
  /// Whether a guard only rises, from within rounding below zero: it then has no zero in the step.
  bool rises(int g, int i) const {
    return start_.rate[g][i] > 0 && end_.rate[g][i] > 0 &&
           (is_instant(i) || (start_.value[g][i] <= 0 && end_.value[g][i] >= 2 * start_.value[g][i]));
  }
  /// The earliest zero of the guards' cubics in the step of lane i.
  Zero first_zero(int i) const {
    Zero first;
    for (int g = 0; g < guard_count(); ++g) {
      if (!candidate_[g][i] || rises(g, i)) continue;
      const Node a = integrate::start_node(start_.value[g][i], start_.rate[g][i] * step_.h[i]),
                 b{1, end_.value[g][i], end_.rate[g][i] * step_.h[i]};
      const double s = integrate::zero_between(
          a, b, [&](double x) { return cubic(a, b, x); }, kZeroTolerance);
      if (s < first.s) first = {g, s};
    }
    return first;
  }

  /// Times closer than this are equal [s].
  static double resolution(double t) { return 4 * std::numeric_limits<double>::epsilon() * std::max(t, 1e-10); }

  enum class StepEnd { kPlain, kCut, kEvent };
  /// Classifies a step with a candidate guard: an event if its zero is within reach of the end, else cut at the zero.
  [[gnu::noinline]] StepEnd end_of_step(int i) {
    constexpr double kReach = 3e-4;  // of the step: an error in time that is corrected along the field
    constexpr int kMaxCuts = 12;
    if (!cut_[i]) cut_count_[i] = 0;
    if (cut_[i] && step_.h[i] == 0) return StepEnd::kEvent;  // cut to length 0: the guard falls from the start
    Zero c = first_zero(i);
    if (c.guard < 0 && cut_[i]) c = {event_guard_[i], 1};  // the cubic's zero was a little early
    if (c.guard < 0) return StepEnd::kPlain;
    const double g = end_.value[c.guard][i], rate = end_.rate[c.guard][i], shift = -g / rate;
    const double reach = std::max(kReach * step_.h[i], resolution(step_.t[i]));
    event_guard_[i] = c.guard;
    if (rate < 0 && (std::abs(shift) <= reach || is_instant(i) || (cut_count_[i] >= kMaxCuts && g <= 0))) {
      shift_.set(i, std::clamp(shift, -step_.h[i], is_instant(i) ? std::max(reach, step_.h[i]) : std::abs(shift)));
      return StepEnd::kEvent;
    }
    if (c.s >= 1 || cut_count_[i] >= kMaxCuts) return StepEnd::kPlain;
    ++cut_count_[i];
    cut_h_.set(i, c.s * step_.h[i]);
    return StepEnd::kCut;
  }

  // --- every lane at once ---

  /// The largest square of a quantity, its time, and the square at the start of the step.
  struct RunningMaximum {
    T square{0.0}, t{0.0}, start{0.0};
  };
  UKEMI_INLINE void update_maximum(RunningMaximum& x, const M& where, const T& q, const T& t) {
    const M higher = where & (q > x.square);
    if (!any(higher)) return;
    assign(x.square, higher, q), assign(x.t, higher, t);
    if (&x != &peak_) return;
    for (int i = 0; i < W; ++i)
      if (higher[i]) landing().peak_raised(i);
  }
  /// Restarts tracking after an event or at the start; q: the square there.
  UKEMI_INLINE void track_start(RunningMaximum& x, const M& where, const T& q) {
    assign(x.start, where, q);
    update_maximum(x, where, q, step_.t);
  }

  /// Recomputes field and guards of stale lanes, and handles immediate events.
  UKEMI_BATCH_STAGE void restart_lanes() {
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
      track_start(peak_, settled, Landing::peak_square(system_, step_.y, dy));
      landing().start_other_maxima(settled);
      stale_ = M(false);
      if (!any(violated)) return;
      for (int i = 0; i < W; ++i)
        if (violated[i]) cross_immediate(i);
    }
  }
  [[gnu::noinline]] void cross_immediate(int i) {
    if (step_.t[i] != t_event_[i]) t_event_[i] = step_.t[i], immediate_count_[i] = 0;
    if (++immediate_count_[i] > integrate::kMaxImmediateEvents) return landing().finish(i, End::kFailed);
    for (int k = 0; k < guard_count(); ++k)
      if (start_.value[k][i] <= 0 && start_.rate[k][i] < 0) {
        if (!landing().cross(i, k)) landing().finish(i, End::kBroken);
        return;
      }
  }

  UKEMI_BATCH_STAGE void attempt() {
    to_deadline_ = step_.t + T(kControl.slack) * h_next_ >= stop_;
    const T h = select(to_deadline_, T(stop_ - step_.t), h_next_);
    step_.h = select(cut_, cut_h_, select(active_, h, T(0.0)));
    to_deadline_ &= !cut_;
    step_.advance([this](const T& t, const State& y, State& dy) UKEMI_INLINE_LAMBDA { field(t, y, dy); });
  }
  UKEMI_BATCH_STAGE void field(const T& t, const State& y, State& dy) const { system_.derivative(t, y, dy); }
  UKEMI_BATCH_STAGE void guards(const T& t, const State& y, const State& dy, typename System::GuardValues& g) const {
    system_.guards(t, y, dy, g);
  }

  /// Classifies the steps: accepted, rejected, cut short or ended by an event; sets the next step lengths.
  UKEMI_BATCH_STAGE void control_steps() {
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
        select(finite(error2), T(kControl.safety) * inverse_tenth_root(max(error2, T(1e-24))), T(kControl.failed));
    const T growth = max(T(kControl.min), min(factor, select(rejected_ | !accepted_, T(1.0), T(kControl.max))));
    T next = min(step_.h * growth, T(kMaxStep));
    next = min(next, landing().longest_step());
    const M updated = active_ & !(cut_ & accepted_);
    assign(h_next_, updated, select(accepted_ & to_deadline_, max(next, h_next_), next));
    rejected_ = active_ & !accepted_;

    guards(step_.t + step_.h, step_.y_end, step_.slope_end, end_);
    M has_candidate = cut_;
    for (int k = 0; k < guard_count(); ++k) {
      const T third(1.0 / 3), a = start_.value[k], b = end_.value[k];
      const T inner = min(a + step_.h * third * start_.rate[k], b - step_.h * third * end_.rate[k]);
      has_candidate |= candidate_[k] = (b <= T(0.0)) | (inner <= T(0.0));
    }
    has_candidate &= accepted_;
    event_ = M(false), shift_ = T(0.0);
    M cut(false);
    if (any(has_candidate))
      for (int i = 0; i < W; ++i)
        if (has_candidate[i]) {
          const StepEnd step_end = end_of_step(i);
          event_.set(i, step_end == StepEnd::kEvent), cut.set(i, step_end == StepEnd::kCut);
        }
    // A cut step without an event: the cubic of the long step does not predict the next step.
    constexpr double kAfterCut = 8;  // times the cut length, at most
    const M missed = cut_ & accepted_ & !event_ & !cut;
    assign(h_next_, missed, min(h_next_, T(kAfterCut) * step_.h));
    cut_ = cut;
    accepted_ &= !cut;
  }

  UKEMI_BATCH_STAGE void track_maxima() {
    track(peak_, [this](const T&, const State& y, const State& dy)
                     UKEMI_INLINE_LAMBDA { return Landing::peak_square(system_, y, dy); });
    landing().track_other_maxima();
  }
  /// Updates a maximum by the ends of the accepted steps, and by the interior of those that could hold a larger value.
  /// square_of(t, y, dy): the squares of all lanes.
  template <class SquareOf>
  UKEMI_INLINE void track(RunningMaximum& x, SquareOf&& square_of) {
    const T q_rate = square_of(T(step_.t + step_.h), step_.y_end, step_.slope_end);
    const T q_end = select(event_, q_rate + (q_rate - x.start) * shift_ / max(step_.h, T(1e-12)), q_rate);
    update_maximum(x, accepted_, q_end, step_.t + step_.h + shift_);
    constexpr double kInside = 0.5, kCandidate = 0.9;  // as squares; see peak_tracker.hpp
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
      update_maximum(x, inside, qb, step_.t + b * step_.h);
      for (int n = 0; n < 3; ++n) {
        const T u = (qb - qa) / (b - a), v = (qc - qb) / (c - b), bend = (v - u) / (c - a);
        const T top = T(0.5) * (a + b - u / bend);
        const M open = inside & (bend < T(0.0)) & (top > a) & (top < c) & (abs(top - b) > T(1e-4)) &
                       (max(qa, max(qb, qc)) > T(kCandidate) * x.square);
        if (!any(open)) break;
        const T s = select(open, top, b), q = at(s);
        update_maximum(x, open, q, step_.t + s * step_.h);
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

  /// Moves accepted lanes to the ends of their steps; handles deadlines, events and ends of landings.
  UKEMI_BATCH_STAGE void finish_step() {
    const T h = step_.h + shift_;
    assign(step_.t, accepted_, step_.t + h);
    for (int k = 0; k < kStates; ++k) {
      assign(step_.y[k], accepted_, step_.y_end[k] + shift_ * step_.slope_end[k]);
      assign(step_.slope[k], accepted_, step_.slope_end[k]);
    }
    for (int k = 0; k < guard_count(); ++k)
      assign(start_.value[k], accepted_, end_.value[k]), assign(start_.rate[k], accepted_, end_.rate[k]);

    const M no_event = accepted_ & !event_, at_deadline = no_event & to_deadline_;
    std::array<std::optional<End>, W> end{};
    if (any(at_deadline))
      for (int i = 0; i < W; ++i)
        if (at_deadline[i]) end[i] = landing().reached(i);
    landing().stepped();
    const M abandoned = landing().abandoned(accepted_), broken = landing().breaking(accepted_),
            rest = landing().resting(no_event);
    const M underflow = rejected_ & (h_next_ < T(4 * std::numeric_limits<double>::epsilon()) * max(step_.t, T(1e-10)));
    steps_ += select(active_, T(1.0), T(0.0));
    const M failed = underflow | (active_ & ((steps_ > T(double(max_steps_))) | landing().given_up()));
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
      else if (event_[i] && !landing().cross(i, event_guard_[i]))
        landing().finish(i, End::kBroken);
    }
  }

  static constexpr double kMaxStep = 0.1;  ///< [s]

  System system_;
  integrate::Step<integrate::DormandPrince54, T, kStates> step_;
  typename System::GuardValues start_, end_;
  T h_next_{0.0}, cut_h_{0.0}, shift_{0.0}, stop_{0.0}, abandon_square_{0.0};
  RunningMaximum peak_;
  T steps_{0.0};
  M active_, stale_, cut_, rejected_, accepted_, event_, to_deadline_;
  std::array<T, kStates> unit_;
  std::array<M, kGuards> candidate_;  ///< guards that may have a zero in the step
  std::array<int, W> event_guard_{}, immediate_count_{}, cut_count_{};
  int guards_ = 0;                   ///< see guard_count
  std::array<double, W> t_event_{};  ///< the instant of immediate_count_

 private:
  Landing& landing() { return static_cast<Landing&>(*this); }
  /// Number of guards in use in any lane: the first ones; a constant without dry friction.
  UKEMI_INLINE int guard_count() const {
    if constexpr (Landing::kMayHaveFriction)
      return guards_;
    else
      return kGuards;
  }

  const double accuracy_;
  const long max_steps_;
};

}  // namespace ukemi::landing

// The discrete course of a landing: the start of its integration, the changes at events and deadlines, and its end. The
// scalar run (follow.hpp), the lanes (landing/lanes) and the run with derivatives (landing/derivatives) only step from
// one to the next.
//
//     released                     phi_I is held                                until flight_limit
//       with a move in the air     phi_R is held until `from`, the move until `to`, then phi_I
//     first touchdown at t_0       detected at t_0 + detection_delay: the motion starts, from the current reference
//     after it                     phi_F is held                                until t_end, or t_0 + Scene::kFollow
#pragma once

#include <algorithm>
#include <limits>
#include <optional>

#include "landing/model/mode.hpp"
#include "landing/model/release.hpp"
#include "landing/run/simulate.hpp"

namespace ukemi::landing {

class Schedule {
 public:
  Schedule() = default;
  /// `moving`: the reference moves after the first touchdown; else phi_F is held from there.
  Schedule(const Scene& scene, const Motion& motion, bool moving)
      : duration_(motion.duration),
        delay_(scene.detection_delay),
        moving_(moving),
        open_ended_(!scene.t_end),
        ballistic_(is_ballistic(scene.drop, motion.release_rate())),
        t_limit_(flight_limit(scene, motion)) {
    if (motion.reposition) reposition_deadline_ = motion.reposition->from, reposition_end_ = motion.reposition->to;
    if (!ballistic_) return;
    const double fall = fall_time(scene);
    start_ = std::min({fall, t_limit_, reposition_deadline_});
    ends_in_flight_ = start_ == t_limit_ && start_ < fall;
  }

  /// Whether the first flight is in closed form until start(), where integration begins [s].
  bool ballistic() const { return ballistic_; }
  double start() const { return start_; }
  /// Whether the run ends in that flight.
  bool ends_in_flight() const { return ends_in_flight_; }
  /// The change of the reference at start().
  ReferenceChange initial_change(Mode& mode) {
    return start_ < reposition_deadline_ ? ReferenceChange::kNone : change_reposition(mode);
  }
  /// The first step after start() [s].
  double first_step() const { return ballistic_ && reposition_end_ == kNever ? 1e-3 : 1e-2; }
  /// Maximum step while the reference moves, so that steps do not skip the motion [s].
  double motion_max_step() const { return 0.125 * (in_air() ? reposition_end_ - reposition_start_ : duration_); }
  /// The next deadline, which no step may cross [s].
  double stop() const { return std::min({t_limit_, reposition_deadline_, detection_, motion_end_}); }

  /// The changes at a guard.
  struct Crossing {
    bool touchdown = false, liftoff = false;
    bool first = false;                               ///< the first touchdown
    bool forbidden = false;                           ///< touchdown of a forbidden point; nothing was changed
    ReferenceChange change = ReferenceChange::kNone;  ///< of the reference
  };
  /// Changes the mode at the zero of `guard` at time t.
  Crossing cross(int guard, double t, Mode& mode, const Limits& limits, ContactOrder& contacts) {
    Crossing out;
    if (guard < kPoints) {
      const Point point = Point(guard);
      out.touchdown = mode.contact[std::size_t(guard)] == Contact::kClear;
      out.liftoff = !out.touchdown;
      out.forbidden = out.touchdown && limits.forbidden[std::size_t(guard)];
      if (out.forbidden) return out;
      out.touchdown ? contacts.touchdown(point, t) : contacts.liftoff(point, t);
      out.first = out.touchdown && !touched_;
      if (out.first) out.change = first_touchdown(t, mode);
    }
    mode.cross(guard);
    return out;
  }

  /// The changes at a deadline: how the run ended, or the change of the reference.
  struct Deadline {
    std::optional<End> end;
    ReferenceChange change = ReferenceChange::kNone;
  };
  Deadline reached(double t, Mode& mode) {
    constexpr double kRounding = 1e-14;  // [s]
    const double now = t + kRounding;
    Deadline out;
    if (now >= reposition_deadline_) out.change = change_reposition(mode);
    if (now >= detection_) out.change = land(t, mode);
    if (now >= motion_end_) mode.phase = Phase::kAfter, motion_end_ = kNever, out.change = ReferenceChange::kHoldFinal;
    if (now >= t_limit_) out.end = touched_ ? End::kTimeLimit : End::kNoContact;
    return out;
  }
  /// Whether the time limit does not depend on the first touchdown.
  bool fixed_end() const { return !open_ended_ || !touched_; }

 private:
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  bool in_air() const { return reposition_deadline_ < kNever; }

  /// The change due at reposition_deadline_.
  ReferenceChange change_reposition(Mode& mode) {
    const bool begins = reposition_deadline_ < reposition_end_;
    reposition_start_ = reposition_deadline_;
    reposition_deadline_ = begins ? reposition_end_ : kNever;
    mode.phase = begins ? Phase::kMoving : Phase::kBefore;
    return begins ? ReferenceChange::kReposition : ReferenceChange::kHoldInitial;
  }

  /// The first touchdown.
  ReferenceChange first_touchdown(double t, Mode& mode) {
    touched_ = true;
    if (open_ended_) t_limit_ = t + Scene::kFollow;
    if (delay_ == 0) return land(t, mode);
    detection_ = t + delay_;
    return ReferenceChange::kNone;
  }
  ReferenceChange land(double t, Mode& mode) {
    reposition_deadline_ = detection_ = kNever;
    mode.phase = moving_ ? Phase::kMoving : Phase::kAfter;
    if (moving_) motion_end_ = t + duration_;
    return ReferenceChange::kLand;
  }

  double duration_ = 0, delay_ = 0;  ///< of the motion; Scene::detection_delay [s]
  bool moving_ = false, open_ended_ = false, ballistic_ = false, ends_in_flight_ = false, touched_ = false;
  double t_limit_ = kNever, start_ = 0, detection_ = kNever, motion_end_ = kNever;
  double reposition_deadline_ = kNever, reposition_end_ = kNever;  ///< next change of the move in the air; its end [s]
  double reposition_start_ = 0;                                    ///< [s]
};

}  // namespace ukemi::landing

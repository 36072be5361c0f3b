// The discrete course of a landing, in one place: where its integration begins, what every event and every deadline
// changes, and when it ends. The scalar run (follow.hpp), the lanes (landing/lanes) and the run with derivatives
// (landing/derivatives) only step from one to the next.
//
//     released                     phi_I is held                                until flight_limit
//       with a move in the air     phi_R is held until `from`, the move until `to`, then phi_I
//     first touchdown at t_0       noticed at t_0 + detection_delay: the motion starts, from where the reference is
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
  /// `moving`: the motion is played from the first touchdown on; else its end is held from there.
  Schedule(const Scene& scene, const Motion& motion, bool moving)
      : duration_(motion.duration),
        delay_(scene.detection_delay),
        moving_(moving),
        open_(!scene.t_end),
        ballistic_(is_ballistic(scene.drop, motion.release_rate())),
        limit_(flight_limit(scene, motion)) {
    if (motion.reposition) air_ = motion.reposition->from, to_ = motion.reposition->to;
    if (!ballistic_) return;
    const double fall = fall_time(scene);
    start_ = std::min({fall, limit_, air_});
    flies_on_ = start_ == limit_ && start_ < fall;
  }

  /// The first flight is known in closed form, until start() [s].
  bool ballistic() const { return ballistic_; }
  double start() const { return start_; }
  /// The run ends in that flight.
  bool flies_on() const { return flies_on_; }
  /// What the reference does at start().
  ReferenceChange opening(Mode& mode) { return start_ < air_ ? ReferenceChange::kNone : change(mode); }
  /// The first step after start() [s].
  double first_step() const { return ballistic_ && to_ == kNever ? 1e-3 : 1e-2; }
  /// A step while the reference moves is no longer, or a few steps would skip the motion [s].
  double motion_part() const { return 0.125 * (in_air() ? to_ - start_of_move_ : duration_); }
  /// The next deadline: no step goes beyond it [s].
  double stop() const { return std::min({limit_, air_, detected_, motion_end_}); }

  /// What crossing a guard changed.
  struct Crossing {
    bool touchdown = false, liftoff = false;
    bool first = false;                               ///< the first touchdown
    bool forbidden = false;                           ///< a point that must not touch; nothing was changed
    ReferenceChange change = ReferenceChange::kNone;  ///< of the reference
  };
  /// Guard `guard` has fallen through zero at time t: into the mode beyond it.
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
      if (out.first) out.change = touch(t, mode);
    }
    mode.cross(guard);
    return out;
  }

  /// What the end of a step at stop() means: how the run ended, or what the reference does now.
  struct Deadline {
    std::optional<End> end;
    ReferenceChange change = ReferenceChange::kNone;
  };
  Deadline reached(double t, Mode& mode) {
    constexpr double kRounding = 1e-14;  // [s]
    const double now = t + kRounding;
    Deadline out;
    if (now >= air_) out.change = change(mode);
    if (now >= detected_) out.change = land(t, mode);
    if (now >= motion_end_) mode.phase = Phase::kAfter, motion_end_ = kNever, out.change = ReferenceChange::kHold;
    if (now >= limit_) out.end = touched_ ? End::kTimeLimit : End::kNoContact;
    return out;
  }
  /// Whether the run's end stands fixed, and does not follow the first touchdown.
  bool fixed_end() const { return !open_ || !touched_; }

 private:
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  bool in_air() const { return air_ < kNever; }

  /// The next change of the move in the air, whose time has come.
  ReferenceChange change(Mode& mode) {
    const bool begins = air_ < to_;
    start_of_move_ = air_;
    air_ = begins ? to_ : kNever;
    mode.phase = begins ? Phase::kMoving : Phase::kBefore;
    return begins ? ReferenceChange::kReposition : ReferenceChange::kStand;
  }

  /// The first touchdown.
  ReferenceChange touch(double t, Mode& mode) {
    touched_ = true;
    if (open_) limit_ = t + Scene::kFollow;
    if (delay_ == 0) return land(t, mode);
    detected_ = t + delay_;
    return ReferenceChange::kNone;
  }
  ReferenceChange land(double t, Mode& mode) {
    air_ = detected_ = kNever;
    mode.phase = moving_ ? Phase::kMoving : Phase::kAfter;
    if (moving_) motion_end_ = t + duration_;
    return ReferenceChange::kLand;
  }

  double duration_ = 0, delay_ = 0;  ///< of the motion; see Scene::detection_delay [s]
  bool moving_ = false, open_ = false, ballistic_ = false, flies_on_ = false, touched_ = false;
  double limit_ = kNever, start_ = 0, detected_ = kNever, motion_end_ = kNever;
  double air_ = kNever, to_ = kNever;  ///< the next change of the move in the air, and its last [s]
  double start_of_move_ = 0;           ///< [s]
};

}  // namespace ukemi::landing

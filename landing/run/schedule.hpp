// The discrete course of a landing, told once: where its integration begins, what every event and every deadline
// changes, and when it ends. The scalar run (follow.hpp), the lanes (landing/lanes) and the run with derivatives
// (landing/derivatives) only step from one to the next.
//
//     before the first touchdown   phi_I is held                      until flight_limit
//     first touchdown at t_0       the motion starts, if it moves     until t_0 + duration
//     after it                     phi_F is held                      until t_end, or t_0 + Scene::kFollow
// Private: not installed.
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
  Schedule(const Scene& scene, double duration, bool moving)
      : duration_(duration),
        moving_(moving),
        open_(!scene.t_end),
        ballistic_(is_ballistic(scene)),
        limit_(flight_limit(scene)) {
    if (!ballistic_) return;
    const double fall = fall_time(scene);
    start_ = std::min(fall, limit_);
    flies_on_ = start_ < fall;
  }

  /// The first flight is known in closed form, until start() [s].
  bool ballistic() const { return ballistic_; }
  double start() const { return start_; }
  /// The run ends in that flight.
  bool flies_on() const { return flies_on_; }
  /// The first step behind it [s].
  double first_step() const { return ballistic_ ? 1e-3 : 1e-2; }
  /// A step while the motion is played is no longer, or the motion is passed over in a few steps [s].
  double motion_part() const { return 0.125 * duration_; }
  /// The next deadline: no step goes beyond it [s].
  double stop() const { return std::min(limit_, motion_end_); }

  /// What crossing a guard did.
  struct Crossing {
    bool touchdown = false, liftoff = false;
    bool first = false;      ///< of all touchdowns: the motion's time starts here
    bool forbidden = false;  ///< a point that must not touch; nothing was changed
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
      if (out.first) land(t, mode);
    }
    mode.cross(guard);
    return out;
  }

  /// A step has ended at stop(), at time t: the motion is over, or the run is; how the latter ended.
  std::optional<End> reached(double t, Mode& mode) {
    constexpr double kRounding = 1e-14;  // [s]
    if (t >= motion_end_ - kRounding) mode.phase = Phase::kAfter, motion_end_ = kNever;
    if (t < limit_ - kRounding) return std::nullopt;
    return touched_ ? End::kTimeLimit : End::kNoContact;
  }
  /// Whether the run's end stands fixed, and does not follow the first touchdown.
  bool fixed_end() const { return !open_ || !touched_; }

 private:
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  void land(double t, Mode& mode) {
    touched_ = true;
    mode.phase = moving_ ? Phase::kMoving : Phase::kAfter;
    if (moving_) motion_end_ = t + duration_;
    if (open_) limit_ = t + Scene::kFollow;
  }

  double duration_ = 0;  ///< of the motion [s]
  bool moving_ = false, open_ = false, ballistic_ = false, flies_on_ = false, touched_ = false;
  double limit_ = kNever, start_ = 0, motion_end_ = kNever;
};

}  // namespace ukemi::landing

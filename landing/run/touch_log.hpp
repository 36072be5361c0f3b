// Records the touches of a landing of any robot, and the peaks between them.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "landing/run/peak_tracker.hpp"
#include "landing/run/simulate.hpp"

namespace ukemi::landing {

class TouchLog {
 public:
  /// Writes into `touches` and `peaks`.
  TouchLog(std::vector<Touch>& touches, std::vector<Peak>& peaks) : touches_(touches), peaks_(peaks) {
    current_touch_.fill(-1);
  }

  PeakTracker since;  ///< peak since the last touchdown

  void touchdown(int point, double t) {
    bool chatter = false;
    for (auto it = touches_.rbegin(); it != touches_.rend(); ++it)
      if (it->point == point) {
        chatter = t - it->t_liftoff < kChatter;
        break;
      }
    finish_touch();
    if (!chatter) finish_interval(point);
    touches_.push_back({point, t, std::numeric_limits<double>::quiet_NaN()});
    current_touch_[std::size_t(point)] = int(touches_.size()) - 1;
  }
  void liftoff(int point, double t) {
    if (Touch* const touch = current(point)) touch->t_liftoff = t;
    current_touch_[std::size_t(point)] = -1;
  }
  /// The current touch of a point; null if it does not touch.
  Touch* current(int point) {
    const int at = current_touch_[std::size_t(point)];
    return at < 0 ? nullptr : &touches_[std::size_t(at)];
  }
  void finish() { finish_touch(), finish_interval(-1); }

 private:
  /// Stores the peak since the last touchdown in its touch, or touches if simultaneous, and in the interval.
  void finish_touch() {
    const double peak = std::sqrt(since.square);
    for (auto it = touches_.rbegin();
         peak > 0 && it != touches_.rend() && it->t_touchdown == touches_.back().t_touchdown; ++it)
      it->peak_acc = peak;
    if (peak > interval_.acceleration) interval_.t = since.t, interval_.acceleration = peak;
    since.reset();
  }
  void finish_interval(int next) {
    if (interval_.acceleration > 0) peaks_.push_back(interval_);
    interval_ = {0, 0, next};
  }

  std::vector<Touch>& touches_;
  std::vector<Peak>& peaks_;
  std::array<int, ContactOrder::kMaxPoints> current_touch_;  ///< index of each point's current touch; -1: none
  Peak interval_{0, 0, -1};
};

}  // namespace ukemi::landing

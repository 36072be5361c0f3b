// The touches of a landing of any robot, and the largest acceleration between them.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "landing/run/peak_tracker.hpp"
#include "landing/run/simulate.hpp"

namespace ukemi::landing {

class TouchLog {
 public:
  /// Writes into these, of a robot with so many contact points.
  TouchLog(std::vector<Touch>& touches, std::vector<Peak>& peaks, std::size_t points)
      : touches_(touches), peaks_(peaks), open_(points, -1) {}

  PeakTracker since;  ///< the last touchdown

  void touchdown(int point, double t) {
    bool chatter = false;
    for (auto it = touches_.rbegin(); it != touches_.rend(); ++it)
      if (it->point == point) {
        chatter = t - it->t_liftoff < kChatter;
        break;
      }
    close_touch();
    if (!chatter) close_interval(point);
    touches_.push_back({point, t, std::numeric_limits<double>::quiet_NaN()});
    open_[std::size_t(point)] = int(touches_.size()) - 1;
  }
  void liftoff(int point, double t) {
    if (Touch* const touch = open(point)) touch->t_liftoff = t;
    open_[std::size_t(point)] = -1;
  }
  /// The touch of a point that is down; else null.
  Touch* open(int point) {
    const int at = open_[std::size_t(point)];
    return at < 0 ? nullptr : &touches_[std::size_t(at)];
  }
  void finish() { close_touch(), close_interval(-1); }

 private:
  /// The next touchdown, or the end of the run, ends what the last one began; an interval holds several of these. Of
  /// points that touch at one instant each gets what follows.
  void close_touch() {
    const double peak = std::sqrt(since.square);
    for (auto it = touches_.rbegin();
         peak > 0 && it != touches_.rend() && it->t_touchdown == touches_.back().t_touchdown; ++it)
      it->peak_acc = peak;
    if (peak > interval_.acceleration) interval_.t = since.t, interval_.acceleration = peak;
    since.reset();
  }
  void close_interval(int next) {
    if (interval_.acceleration > 0) peaks_.push_back(interval_);
    interval_ = {0, 0, next};
  }

  std::vector<Touch>& touches_;
  std::vector<Peak>& peaks_;
  std::vector<int> open_;  ///< index of each point's touch; -1: it is not down
  Peak interval_{0, 0, -1};
};

}  // namespace ukemi::landing

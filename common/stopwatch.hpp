// Elapsed wall-clock and CPU time.
#pragma once

#include <ctime>

namespace ukemi {

enum class StopwatchTime : int {
  kWall,       ///< real time
  kProcessor,  ///< CPU time of the calling thread: for comparisons on a shared machine
  kProcess,    ///< CPU time of all threads of the program
};

class Stopwatch {
 public:
  using Time = StopwatchTime;
  explicit Stopwatch(Time time)
      : clock_(time == Time::kWall        ? CLOCK_MONOTONIC
               : time == Time::kProcessor ? CLOCK_THREAD_CPUTIME_ID
                                          : CLOCK_PROCESS_CPUTIME_ID) {
    restart();
  }
  void restart() { start_ = now(); }
  /// Since the start [s].
  double seconds() const { return now() - start_; }

 private:
  double now() const {
    timespec t;
    if (clock_gettime(clock_, &t) != 0) clock_gettime(CLOCK_MONOTONIC, &t);  // a browser has no CPU clock
    return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
  }
  clockid_t clock_;
  double start_;
};

}  // namespace ukemi

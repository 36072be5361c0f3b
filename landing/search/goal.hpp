// What a search minimises, and the tolerant peak of a motion.
#pragma once

#include <array>

#include "landing/model/motion_data.hpp"
#include "landing/model/scene.hpp"

namespace ukemi::landing {

enum class Goal {
  kPeak,      ///< f(x), Eq. 6 of [1]
  kTolerant,  ///< the worst f within the scene's execution tolerance, see tolerant_peak.hpp
  kRobust,    ///< a measure of the peaks over scattered drops, see robust.hpp
};

/// Above every peak: a motion that could not be followed, or broke a limit [m/s^2].
inline constexpr double kNoMotion = 1e9;

/// Worst peaks within the scene's execution tolerance around a motion x.
struct TolerantPeak {
  double peak = 0;     ///< f(x) [m/s^2]
  double value = 0;    ///< the largest f over x, six face centres and eight corners of the box x + (i da, j da, k dt)
  Motion worst{};      ///< the motion that has it
  double sampled = 0;  ///< the largest f on random points inside the box; may exceed `value`
  int samples = 0;
  std::array<int, kPoints> touching{}, samples_touching{};  ///< of each contact point, how many of the fifteen and
                                                            ///< of the samples touch the floor with it
  bool failed = false;                                      ///< a landing in the box could not be followed
  bool complete = true;  ///< false: options.over ended it early, and `value` is a lower bound
};

/// An improvement of the best of a search.
struct Progress {
  long motions, landings;  ///< evaluated until then
  double seconds;
  double value;  ///< at the accuracy of the search [m/s^2]
};

}  // namespace ukemi::landing

// Profile likelihood: one constant held on a grid, everything else refitted. Where it is not a parabola the linear
// interval is wrong, and this one, asymmetric, is right. The variance from the rig's errors is added to the square of
// each half width.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "identify/trust/diagnostics.hpp"

namespace ukemi::identify {

struct Profile {
  std::string constant, unit;
  std::vector<double> value;  ///< increasing
  std::vector<double> rise;   ///< of the deviance above its minimum; infinite where no rollout is possible
  double threshold = 0;       ///< rise at the ends of the 95 % interval: the squared half width in standard errors
  std::optional<double> low_noise,
      high_noise;                   ///< of the interval by the logs' noise alone; absent where the grid ends
  std::optional<double> low, high;  ///< with the errors of the rig; absent alike
};

struct ProfileOptions {
  int points = 25;        ///< of the grid, odd, 5 at least
  double reach = 3;       ///< standard errors, of noise, to either side, > 0, cut at the bounds
  void validate() const;  ///< throws InputError
};

/// A constant that is profiled.
struct Profiled {
  const Estimate& estimate;
  double half_width;    ///< of its 95 % interval, in standard errors
  double lower, upper;  ///< its bounds
  /// Where the refit at a value starts: at the fit, or at the minimum of the previous value, which is closer to it.
  enum class From { kFit, kLast };
  /// Rise of the deviance with the constant held at a value and all else refitted; infinite where no rollout is
  /// possible.
  std::function<double(double value, From from)> rise;
};
/// Throws InputError where the estimate has no standard error.
[[nodiscard]] Profile profile(const Profiled& constant, const ProfileOptions& options = {});

/// The profile of a constant of `fit`, which must have a standard error (InputError otherwise).
[[nodiscard]] Profile profile(const Experiment& experiment, const Fit& fit, const std::string& constant,
                              const ProfileOptions& options = {});

}  // namespace ukemi::identify

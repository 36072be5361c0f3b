// Profile likelihood: one constant held on a grid, everything else refitted. Where it is not a parabola the linear
// interval misleads, and this one, unsymmetric, holds. What the errors of the rig add to the constant's own error is
// added to each side, as squares.
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
  std::optional<double> low, high;  ///< of the interval with the errors of the rig; as absent
};

struct ProfileOptions {
  int points = 25;        ///< of the grid, odd, 5 at least
  double reach = 3;       ///< standard errors, of noise, to either side, > 0, cut at the bounds
  void validate() const;  ///< throws InputError
};

/// A constant that can be held beside its estimate.
struct Profiled {
  const Estimate& estimate;
  double half_width;    ///< of its 95 % interval, in standard errors
  double lower, upper;  ///< its bounds
  /// Where the refits of a value begin: at the fit, or where those of the value before, one nearer to it, ended.
  enum class From { kFit, kLast };
  /// By how much the deviance rises where it is held at a value and all else is refitted; infinite where no rollout is
  /// possible.
  std::function<double(double value, From from)> rise;
};
/// Throws InputError where the estimate has no standard error.
[[nodiscard]] Profile profile(const Profiled& constant, const ProfileOptions& options = {});

/// The profile of a constant of `fit`, which must have a standard error (InputError otherwise).
[[nodiscard]] Profile profile(const Experiment& experiment, const Fit& fit, const std::string& constant,
                              const ProfileOptions& options = {});

}  // namespace ukemi::identify

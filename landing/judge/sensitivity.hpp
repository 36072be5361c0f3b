// Numerical trust in the peak of a landing.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "common/random.hpp"
#include "landing/run/simulate.hpp"

namespace ukemi::landing {

/// A larger relative change of the peak is not rounding: the landing is sensitive, or the number is wrong.
inline constexpr double kCliff = 1e-3;

struct Sensitivity {
  double error_estimate =
      0;                   ///< relative change of the peak when every step's tolerance is a hundredth (at least 1e-13)
  double change = 0;       ///< largest relative change of the tighter peak over scenes perturbed by 1e-6
  bool sensitive = false;  ///< change > kCliff: the motion is close to a cliff of the objective
  bool checked = false;    ///< the tighter run could be followed; else the rest is unknown
  bool right = false;      ///< the tighter run gives the same peak within kCliff, or the landing is sensitive
};

/// Repeats the landing at a tighter tolerance, also on `draws` scenes with every number perturbed by +-1e-6 relative at
/// random. Only runs that did not fail, their energy balance included (see `simulate`), are compared: a peak that
/// changes with the tolerance and not with the scene is wrong, not sensitive.
[[nodiscard]] Sensitivity sensitivity(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                                      const SimulateOptions& options, double peak, int draws = 8,
                                      std::uint64_t seed = 1);

/// Sensitivity of any robot. `play`: the peak at an accuracy, of the scene or (with `random`) a perturbed one; absent
/// where the run failed.
using PerturbedPeak = std::function<std::optional<double>(double accuracy, Random* random)>;
[[nodiscard]] Sensitivity sensitivity(double peak, double accuracy, const PerturbedPeak& play, int draws,
                                      std::uint64_t seed);
/// Changes a number by +-1e-6 relative at random.
void perturb(double& x, Random& random);

}  // namespace ukemi::landing

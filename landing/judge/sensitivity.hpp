// How far a landing's peak can be trusted as a number.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "common/random.hpp"
#include "landing/run/simulate.hpp"

namespace ukemi::landing {

/// A change of the peak by more than this is not one of rounding: the landing is sensitive, or the number is wrong.
inline constexpr double kCliff = 1e-3;

struct Sensitivity {
  double error_estimate =
      0;                   ///< relative change of the peak when every step's tolerance is a hundredth (at least 1e-13)
  double change = 0;       ///< largest relative change of that tighter peak over scenes moved by 1e-6 relative
  bool sensitive = false;  ///< change > kCliff: the motion is close to a cliff of the objective
  bool checked = false;    ///< the tighter run could be followed; else nothing of the rest is known
  bool right = false;      ///< the tighter run gives the same peak within kCliff, or the landing is sensitive
};

/// Runs the landing again, tighter, and so on `draws` scenes of which every number is moved by 1e-6 relative, up or
/// down at random. Only runs that did not fail are compared, their energy balance included (see `simulate`): a number
/// that moves with the tolerance and not with the scene is wrong, not sensitive.
[[nodiscard]] Sensitivity sensitivity(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                                      const SimulateOptions& options, double peak, int draws = 8,
                                      std::uint64_t seed = 1);

/// Sensitivity of anything that falls. `play` is the peak at a tolerance, of the scene or of one that a random number
/// moves; none where the run failed.
using PeakOfMoved = std::function<std::optional<double>(double accuracy, Random* random)>;
[[nodiscard]] Sensitivity sensitivity(double peak, double accuracy, const PeakOfMoved& play, int draws,
                                      std::uint64_t seed);
/// Moves a number of a scene by 1e-6 relative, up or down.
void move_a_little(double& x, Random& random);

}  // namespace ukemi::landing

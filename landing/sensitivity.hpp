// How far a landing's peak can be trusted as a number.
#pragma once

#include <cstdint>

#include "landing/simulate.hpp"

namespace ukemi::landing {

struct Sensitivity {
  double error_estimate =
      0;                   ///< relative change of the peak when every step's tolerance is a hundredth (at least 1e-13)
  double change = 0;       ///< largest relative change of the peak over scenes moved by 1e-6 relative
  bool sensitive = false;  ///< change > 1e-3: the motion stands beside a cliff of the objective
};

/// Runs the landing again, tighter, and on `draws` scenes of which every number is moved by 1e-6 relative, up or down
/// at random.
[[nodiscard]] Sensitivity sensitivity(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                                      const SimulateOptions& options, double peak, int draws = 8,
                                      std::uint64_t seed = 1);

}  // namespace ukemi::landing

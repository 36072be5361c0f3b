// Eq. 6 of [1]: the motion with the smallest peak acceleration of the thigh.
//
//     min f(x) = max over time of |ddr_0|,   x = [phi_I phi_F t],   within the scene's search range.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "landing/robust.hpp"
#include "landing/simulate.hpp"

namespace ukemi::landing {

struct OptimizeOptions {
  std::string solver = "auto";    ///< auto, or one of nlopt_names()
  long evaluations = 12'000;      ///< landings in all; the stopping rule
  double search_accuracy = 1e-6;  ///< of the landings that are searched
  double accuracy = 1e-9;         ///< of the result
  std::uint64_t seed = 1;
  int threads = 0;                                      ///< 0: all cores; the result does not depend on it
  int tolerance_samples = 200;                          ///< random points inside the execution box of the result
  std::function<void(long done, long total)> progress;  ///< called now and then, from any thread, one at a time
  void validate() const;                                ///< throws InputError
};

struct Optimum {
  Motion motion{};
  LandingPeak landing;    ///< of the motion, at OptimizeOptions::accuracy
  TolerantPeak tolerant;  ///< the same within the execution tolerance
  long evaluations = 0;
  bool found = false;   ///< false: no motion of the range could be followed
  std::string message;  ///< why not
};

/// Searches. `auto` samples the box (abandoning landings that are worse than the best so far need), then polishes the
/// best distinct motions with SBPLX and Nelder-Mead restarts; the others run NLopt from the middle of the box, local
/// ones again from random starts until the evaluations are spent. Deterministic for a seed, whatever the number of
/// threads.
[[nodiscard]] Optimum optimize(const Scene& scene, const SeaParameters<double>& sea,
                               const OptimizeOptions& options = {});

}  // namespace ukemi::landing

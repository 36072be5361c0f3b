// Stiff and extreme landings, each checked: it ends, its numbers are finite, its energy balance closes, and its peak
// does not change when the tolerance is halved, unless the landing itself is measurably sensitive.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "landing/run/simulate.hpp"

namespace ukemi::landing {

/// One landing of the grid.
struct StabilityCase {
  std::string factor;   ///< what is extreme: "K_f", ..., "special", "random"
  std::string setting;  ///< its value, or the combination
  Scene scene;
  SeaParameters<double> sea;
  Motion motion;
};

enum class Verdict {
  kPass,
  kSensitive,  ///< moving the scene by kMove moves its peak by more than kCliff: no tolerance can settle it
  kCoarse,     ///< of lanes: another peak at 1e-6, the right one at 1e-7
  kRefused,    ///< it could not be followed; the reason is given
  kWrong,      ///< a check failed: must never occur
};
const char* name(Verdict verdict);

struct StabilityResult {
  Verdict verdict = Verdict::kWrong;
  std::string reason;          ///< of kRefused and kWrong
  double peak = 0;             ///< [m/s^2]
  double energy_residual = 0;  ///< over the energy turned over
  double halving = 0;          ///< relative change of the peak at half the tolerance
  double sensitivity = 0;  ///< relative change of the peak with the scene moved by 1e-6; measured where halving fails
  Failure failure = Failure::kNone;
  integrate::Counters work;
};

struct StabilityLimits {
  double energy = 1e-6, halving = 1e-3;
  long max_steps = 400'000;
};

/// One factor at a time over the decades, from the base, then special cases, then `random` seeded combinations of three
/// factors each. The same grid for the same arguments; with `stride` > 1 only every stride-th case.
std::vector<StabilityCase> stability_grid(const Scene& base, const SeaParameters<double>& sea, int random,
                                          std::uint64_t seed, int stride = 1);

/// Runs one case at the default accuracy and checks it.
[[nodiscard]] StabilityResult check_stability(const StabilityCase& c, const StabilityLimits& limits = {});

}  // namespace ukemi::landing

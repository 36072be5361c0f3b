// Ordinary landings by the thousand, drawn by their index, each followed three ways that must agree: the scalar path at
// its default accuracy and a hundred times tighter, and in lanes.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "tools/bench/stability.hpp"

namespace ukemi::landing {

/// A motion drawn from the scene's search range; it belongs to its index.
StabilityCase random_motion(const Scene& scene, const SeaParameters<double>& sea, std::uint64_t seed,
                            std::uint64_t index);
/// A robot, floor, drop, actuator and motion drawn about the base: masses, lengths and constants log-uniform within a
/// factor of 3 to 10, any pitch within 90 deg, with and without torque limit, pitch rate and points left out.
StabilityCase random_landing(const Scene& base, const SeaParameters<double>& sea, std::uint64_t seed,
                             std::uint64_t index);

/// The same landing with a drive that has each optional term of its model with probability 1/2: friction, Stribeck's
/// and asymmetric, on both sides, the spring's loss and stiffening, feedback of the motor's side.
StabilityCase with_drive_terms(StabilityCase c, std::uint64_t seed, std::uint64_t index);

/// One landing followed three ways.
struct CrossCheck {
  double scalar = 0;  ///< peak of the scalar path at its default accuracy, 1e-9 [m/s^2]
  double lanes = 0;   ///< in lanes at 1e-6
  double tight = 0;   ///< of the scalar path at 1e-11
  double scalar_difference = 0, lanes_difference = 0;  ///< to `tight`, relative
  double sensitivity = 0;  ///< relative change of the tight peak with the scene moved by 1e-6, where they differ
  Verdict verdict = Verdict::kWrong;
  std::string reason;  ///< of kRefused and kWrong
};
/// Follows every case three ways. Where peaks differ by more than kCliff, moving the scene by 1e-6 must do so as well
/// (kSensitive), or the lanes' accuracy must be what differs (kCoarse: a touchdown beside another one's chatter, say);
/// else kWrong. On `threads` threads, without influence on the results.
[[nodiscard]] std::vector<CrossCheck> cross_check(std::span<const StabilityCase> cases, int threads);

}  // namespace ukemi::landing

// Stiff and extreme landings, and what must hold for each: it ends, its numbers are finite, its energy balance closes,
// and its peak stands when the tolerance is halved, unless the landing itself is measurably sensitive. And ordinary
// ones by the thousand, each followed three ways that must agree: the scalar path at its default accuracy and a hundred
// times tighter, and in lanes.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "landing/run/simulate.hpp"

namespace ukemi::landing {

/// One landing of the grid.
struct StabilityCase {
  std::string factor;   ///< what is extreme: "K_f", ..., "special", "random"
  std::string setting;  ///< its value, or what the combination is
  Scene scene;
  SeaParameters<double> sea;
  Motion motion;
};

enum class Verdict {
  kPass,
  kSensitive,  ///< moving the scene by kMove moves its peak by more than kCliff: no tolerance can settle it
  kCoarse,     ///< of lanes: another peak at 1e-6, the right one at 1e-7
  kRefused,    ///< it could not be followed; the reason is given
  kWrong,      ///< a check failed: never to be seen
};
const char* name(Verdict verdict);

struct StabilityResult {
  Verdict verdict = Verdict::kWrong;
  std::string reason;          ///< of kRefused and kWrong
  double peak = 0;             ///< [m/s^2]
  double energy_residual = 0;  ///< over the energy turned over
  double halving = 0;          ///< relative change of the peak with half the tolerance
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

/// Runs one case at the default accuracy and judges it.
[[nodiscard]] StabilityResult judge(const StabilityCase& c, const StabilityLimits& limits = {});

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

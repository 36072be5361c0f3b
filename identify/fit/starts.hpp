// Where a fit starts: drawn in log space about what the rig and the trials suggest.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/sea.hpp"
#include "identify/rig/rig.hpp"
#include "identify/logs/trial.hpp"

namespace ukemi::identify {

/// What the logs suggest without a fit. From rest to rest the motor and the link together give, torque limit or not,
///     K_p int phi dt = int l cos(phi) F dt        and        K_p int t phi dt - K_d int phi dt = int t l cos(phi) F
///     dt,
/// the rest is scaled from the link's inertia and the log's dominant angular frequency.
struct Suggestion {
  SeaParameters<double> centre;
  double spread_gains;  ///< K_p, K_d lie within this factor, either way
  double spread_rest;   ///< K_SEA, C_SEA, I_motor
};
Suggestion suggest(const Rig& rig, const std::vector<Trial>& trials);

/// `count` sets of constants within the factors about the centre: a Latin hypercube in their logarithms.
std::vector<SeaParameters<double>> draw_starts(const Suggestion& about, int count, std::uint64_t seed);

}  // namespace ukemi::identify

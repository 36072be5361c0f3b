// Where a fit starts: drawn in log space about what the rig and the trials suggest.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/sea_parameters.hpp"
#include "identify/fit/start_options.hpp"
#include "identify/logs/trial.hpp"
#include "identify/rig/rig.hpp"

namespace ukemi::identify {

/// What the logs suggest without a fit. From rest to rest the motor and the link together give, torque limit or not,
///     K_p int phi dt = int T dt    and    K_p int t phi dt - K_d int (phi - phi(0)) dt = int t T dt,
/// with phi measured from the reference and T = l cos(phi_1) F - gravity's torque;
/// the rest is scaled from the link's inertia and the log's dominant angular frequency: of the spring's deflection
/// where the drive's command is known and both sides were logged, else of the link.
struct Suggestion {
  SeaParameters<double> centre;
  double spread_gains;  ///< K_p, K_d lie within this factor, either way
  double spread_rest;   ///< K_SEA, C_SEA, I_motor
  double torque = 0;    ///< largest of the spring: the centre's K_SEA times the logged deflection [Nm]; 0: not logged
  double rate = 0;      ///< largest frequency of the deflection times amplitude of phi [rad/s]
};
Suggestion suggest(const Rig& rig, const std::vector<Trial>& trials);

/// `count` sets of constants within the factors about the centre: a Latin hypercube in their logarithms. Friction on
/// either side, dry and viscous, within spread_rest of the suggested torque, either way, where there is one.
std::vector<SeaParameters<double>> draw_starts(const Suggestion& suggestion, int count, std::uint64_t seed);

}  // namespace ukemi::identify

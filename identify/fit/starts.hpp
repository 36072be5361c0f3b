// Where a fit starts: drawn in log space about what the rig and the trials suggest.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/sea.hpp"
#include "identify/logs/trial.hpp"
#include "identify/rig/rig.hpp"

namespace ukemi::identify {

/// How starts are drawn, screened and followed. Chosen on the eight trials and their subsets; a change must keep
/// test/regression/global.cpp (`test_regression "random actuators*"`) and the cases of `ukemi bench stability`.
struct StartOptions {
  int draws = 240;          ///< that are screened, >= 1
  int draws_near = 60;      ///< the same where the logs give the gains away: Suggestion::spread_gains below 2
  double accuracy = 1e-4;   ///< relative tolerance of a screening rollout
  long steps = 5000;        ///< of a screening rollout at most
  double sample_steps = 3;  ///< and for each sample: enough for what comes near the logs
  double apart = 3;         ///< starts differ by this factor in some constant, > 1: no two from one basin if possible
  double spread = 10;       ///< factor about a given start, either way, in which further ones are drawn
  double fit_steps = 1e5;   ///< a start that asks for more integrated steps than this,
  double fit_sample_steps = 60;  ///< and this for each sample, is ended where it stands
  double fit_starts = 4;         ///< no other is tried once all took so many times that
  void validate() const;         ///< throws InputError
};

/// What the logs suggest without a fit. From rest to rest the motor and the link together give, torque limit or not,
///     K_p int phi dt = int T dt    and    K_p int t phi dt - K_d int (phi - phi(0)) dt = int t T dt,
/// phi from the reference, T = l cos(phi_1) F - gravity's pull;
/// the rest is scaled from the link's inertia and the log's dominant angular frequency: of the spring's deflection
/// where the drive's command is known and both sides were logged, else of the link.
struct Suggestion {
  SeaParameters<double> centre;
  double spread_gains;  ///< K_p, K_d lie within this factor, either way
  double spread_rest;   ///< K_SEA, C_SEA, I_motor
  double torque = 0;    ///< largest of the spring, by K_SEA of the centre and the deflection where that was logged [Nm]
  double rate = 0;      ///< fastest of the deflection's swings [rad/s]
};
Suggestion suggest(const Rig& rig, const std::vector<Trial>& trials);

/// `count` sets of constants within the factors about the centre: a Latin hypercube in their logarithms. Friction on
/// either side, dry and viscous, within spread_rest of the suggested torque, either way, where there is one.
std::vector<SeaParameters<double>> draw_starts(const Suggestion& about, int count, std::uint64_t seed);

}  // namespace ukemi::identify

// The rig of the paper and its simulated trials: what made them is known (Table 2, normal noise).
#pragma once

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "common/actuator.hpp"
#include "common/random.hpp"
#include "identify/fit/fit.hpp"
#include "identify/rollout/rollout.hpp"
#include "test/folder.hpp"

namespace test {

using namespace ukemi;
using namespace ukemi::identify;

inline constexpr std::array<double, kConstants> kTruth = {50, 1, 65, 1.6, 0.085};  // Table 2
inline constexpr double kNoise = 5e-4;                                             ///< of the trials' angles [rad]

inline Rig rig() { return read_rig(UKEMI_DATASETS "/rigs/paper.toml"); }

/// These constants with the rig's torque limit.
inline SeaParameters<double> limited(const std::array<double, kConstants>& constants = {}) {
  SeaParameters<double> sea{};
  set_constants(sea, constants);
  sea.tau_max = *rig().tau_max;
  return sea;
}
inline SeaParameters<double> truth() { return limited(kTruth); }

inline Trial shipped(int number) {
  return read_trial(UKEMI_DATASETS "/impact/trial_" + std::to_string(number) + ".csv");
}
/// All eight, of one of the folders that hold them.
inline std::vector<Trial> shipped(const std::string& folder = "impact") {
  std::vector<Trial> out;
  for (int i = 1; i <= 8; ++i)
    out.push_back(read_trial(UKEMI_DATASETS "/" + folder + "/trial_" + std::to_string(i) + ".csv"));
  return out;
}

/// Trials whose angles are the rig's own, without noise.
inline std::vector<Trial> simulated(std::vector<Trial> trials, const SeaParameters<double>& sea,
                                    const Nuisance<double>& nuisance = {}) {
  for (Trial& t : trials) {
    std::vector<double> phi, phi_m;
    REQUIRE(rollout<double>(rig(), sea, nuisance, PreparedTrial(t), {}, phi, phi_m) == RolloutStatus::kDone);
    t.phi = phi;
  }
  return trials;
}

/// With noise that belongs to the seed and the trial's place.
inline std::vector<Trial> noisy(std::vector<Trial> trials, std::uint64_t seed) {
  for (std::size_t m = 0; m < trials.size(); ++m) {
    Random random(seed, m);
    for (double& x : trials[m].phi) x += kNoise * random.normal();
  }
  return trials;
}

/// What a fit found for a term of all trials.
inline const Estimate& estimate(const Fit& fit, const std::string& name) {
  for (const Estimate* e : fit.globals())
    if (e->name == name) return *e;
  FAIL(name + " was not fitted");
  return fit.parameters.front();
}
/// The largest error of a constant in its own standard errors, of those that have one.
inline double worst_error(const Fit& fit, const std::array<double, kConstants>& truth = kTruth) {
  double out = 0;
  for (std::size_t k = 0; k < kConstants; ++k)
    if (const Estimate& e = fit.parameters[k]; e.std) out = std::max(out, std::abs(e.value - truth[k]) / *e.std);
  return out;
}

/// How far a derivative is off the difference of a function at +-h and +-2h from there, and how large it is.
struct SlopeError {
  double worst = 0, size = 0;
};
template <class Function, class Derivative>
SlopeError slope_error(double h, Function&& moved_by, Derivative&& derivative) {
  const std::vector<double> up = moved_by(h), down = moved_by(-h), far = moved_by(2 * h), below = moved_by(-2 * h);
  SlopeError out;
  for (std::size_t i = 0; i < up.size(); ++i) {
    const double slope = (8 * (up[i] - down[i]) - (far[i] - below[i])) / (12 * h);
    out.size = std::max(out.size, std::abs(slope)), out.worst = std::max(out.worst, std::abs(derivative(i) - slope));
  }
  return out;
}

/// How many draws a statistical test takes; the full run: UKEMI_DRAWS=200.
inline int draws(int normally) {
  const char* asked = std::getenv("UKEMI_DRAWS");
  return asked ? std::atoi(asked) : normally;
}

/// A measured arm at a step of its reference, with Eq. 3 on its motor.
struct Arm {
  Rig rig{.length = 0.45, .inertia = 0.01418, .tau_max = {}, .gear_ratio = {}, .feedback = Feedback::kMotor};
  SeaParameters<double> base{.feedback = Feedback::kMotor};
  std::vector<Trial> log;
};
/// None, and a warning, where it is not at hand.
inline std::optional<Arm> measured_arm() {
  const auto path = lab_file("rotary_arm/step_up.csv");
  if (!path) return std::nullopt;
  return Arm{.log = {read_trial(*path)}};
}

}  // namespace test

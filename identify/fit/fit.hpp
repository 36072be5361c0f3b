// Identification (Sec. 3 of [1]): the constants that make the rollouts of all trials meet the logs,
//
//     min E(U) = sum_m sum_n (phi_exp[m](n) - phi_sim[m](n))^2,   U = [K_p K_d K_SEA C_SEA I_motor] >= 0,
//
// with standard errors from the Fisher information scaled by the residual variance.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "common/actuator.hpp"
#include "common/monitor.hpp"
#include "identify/rollout/rollout.hpp"
#include "identify/fit/uncertainty.hpp"
#include "identify/fit/weighting.hpp"

namespace ukemi::identify {

/// Terms that may be fitted along with the constants: see SeaParameters and Nuisance.
enum class NuisanceTerm {
  kFriction,       ///< Coulomb torque on the motor, one for all trials [Nm], >= 0
  kViscous,        ///< viscous friction on the motor, one for all trials [Nm/(rad/s)], >= 0
  kStiffening,     ///< K_3 of the spring, one for all trials [Nm/rad^3], >= 0
  kForceGain,      ///< one for all trials
  kInitialAngle,   ///< a trial each [rad]
  kInitialRate,    ///< a trial each [rad/s]
  kEncoderOffset,  ///< a trial each [rad]
  kForceBias,      ///< a trial each [N]
  kTimeShift,      ///< a trial each [s], within 0.1 s either way
};
inline constexpr std::array kNuisanceTerms = {
    NuisanceTerm::kFriction,      NuisanceTerm::kViscous,      NuisanceTerm::kStiffening,
    NuisanceTerm::kForceGain,     NuisanceTerm::kInitialAngle, NuisanceTerm::kInitialRate,
    NuisanceTerm::kEncoderOffset, NuisanceTerm::kForceBias,    NuisanceTerm::kTimeShift};
const char* name(NuisanceTerm t);
const char* unit(NuisanceTerm t);
/// Whether all trials share it.
constexpr bool is_shared(NuisanceTerm t) { return t <= NuisanceTerm::kForceGain; }

/// What is known of a constant beforehand.
struct Prior {
  double value, std;  ///< in the constant's unit; std > 0
};

struct FitOptions {
  std::array<bool, kConstants> free{true, true, true, true, true};  ///< the others stay at the start
  std::array<double, kConstants> lower{};                           ///< >= 0
  std::array<double, kConstants> upper{kInfinity, kInfinity, kInfinity, kInfinity, kInfinity};
  std::vector<NuisanceTerm> nuisance;                  ///< each at most once
  std::array<std::optional<Prior>, kConstants> prior;  ///< counted like one more measurement
  double huber = 0;                                    ///< Huber's delta on each sample's residual [rad]; 0: squares
  enum class Weights { kEqual, kTrial } weights = Weights::kEqual;  ///< kTrial: 1 / each trial's own residual variance
  double accuracy = 1e-9;                                           ///< relative tolerance of the rollout
  std::optional<Method> method;                 ///< of the rollout, for comparison; see RolloutOptions
  double max_step = RolloutOptions{}.max_step;  ///< of the rollout [s]
  double escape = kEscape;                      ///< [rad]; infinite for multi-turn trials
  int restarts = 10;                            ///< further starts where the residual stays far above the noise
  int explore = 0;         ///< starts in all, whatever the residual, to see which minima there are; 0: as few as needed
  int threads = 0;         ///< 0: all cores; without influence on the results
  std::uint64_t seed = 1;  ///< of the drawn starts
  int max_iterations = 200;  ///< of the solver, each start
  Monitor monitor;           ///< told of starts; where it stops the fit, the best so far is kept: Fit::interrupted
  bool fits(NuisanceTerm t) const { return std::find(nuisance.begin(), nuisance.end(), t) != nuisance.end(); }
  RolloutOptions rollout() const {
    return {.accuracy = accuracy, .max_step = max_step, .method = method, .escape = escape};
  }
  void validate() const;  ///< throws InputError

  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
};

/// A minimum that starts ended at.
struct Minimum {
  SeaParameters<double> sea;
  double cost;  ///< like Fit::cost
  int found;    ///< by so many starts
};

struct TrialResult {
  std::string file;
  std::size_t samples = 0;
  double rms = 0;                  ///< over phi and, where measured, phi_motor [rad]; NaN where the rollout failed
  double noise = 0;                ///< the log's own noise [rad]
  std::vector<double> phi, phi_m;  ///< predicted; empty where the rollout failed
  RolloutStatus status = RolloutStatus::kDone;
  Nuisance<double> nuisance;
  Weighting weighting;  ///< of its residuals in the fit
};

struct Fit {
  SeaParameters<double> sea;         ///< the result, tau_max and feedback included
  std::vector<Estimate> parameters;  ///< the five constants, in order
  std::vector<Estimate> nuisance;
  std::vector<std::string> fitted;  ///< order of `covariance`: free constants, then friction
  Eigen::MatrixXd covariance;       ///< NaN where not determined
  Eigen::MatrixXd correlation;
  Eigen::VectorXd eigenvalues;     ///< of the scaled information, ascending, largest 1
  double half_width = 1.96;        ///< 95 % interval in standard errors (Student's t)
  std::optional<Weakest> weakest;  ///< the combination of constants that the trials know least
  double rms = 0;                  ///< unweighted, over every measured output [rad]
  double cost = 0;                 ///< E(U) [rad^2]; weighted or robust where asked for
  bool converged = false, identifiable = false;
  bool far_above_noise = false;  ///< the residual, beyond kFarAboveNoise: no constant is trusted
  bool flawed_logs = false;      ///< a gap in a hit, or a force of the wrong sign: no constant is trusted
  bool interrupted = false;      ///< by the monitor; what stands here is the best until then
  int iterations = 0;            ///< of the start that won
  int starts = 0;                ///< how many were run
  std::vector<Minimum> minima;   ///< that they ended at, the lowest first
  std::vector<std::string> warnings;
  std::vector<TrialResult> trials;
  std::string message;  ///< why it did not converge

  /// What was fitted for all trials, in the order of `fitted`.
  std::vector<const Estimate*> globals() const;
  /// Whether it converged and every fitted constant is trusted.
  bool trusted() const { return converged && all_trusted(parameters); }
};

/// Fits; without `start` one is worked out from the rig and the trials. `base` gives what is not fitted: tau_max,
/// feedback, stiffening, friction. A start at 0 is moved off it. Never throws on numbers: see Fit::converged; where no
/// start could be followed, Fit::fitted is empty. The force is taken as each trial has it: see rest_between_hits; its
/// noise within the hits (Trial::force_noise) weighs the residuals, see Weighting. Bounded in work, whatever the logs:
/// a start that asks for more than 100,000 integrated steps and 60 for each sample is ended where it stands, and no
/// other is tried once all took four times that.
[[nodiscard]] Fit fit(const Rig& rig, const std::vector<Trial>& trials,
                      const std::optional<SeaParameters<double>>& start, const SeaParameters<double>& base,
                      const FitOptions& options = {});

/// The rig's motion for given constants against the logs, nothing fitted. rms is 0 where nothing is measured.
[[nodiscard]] Fit predict(const Rig& rig, const std::vector<Trial>& trials, const SeaParameters<double>& sea,
                          const FitOptions& options = {});

}  // namespace ukemi::identify

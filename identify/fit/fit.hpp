// Identification (Sec. 3 of [1]): the constants that make the rollouts of all trials meet the logs,
//
//     min E(U) = sum_m sum_n (phi_exp[m](n) - phi_sim[m](n))^2,   U = [K_p K_d K_SEA C_SEA I_motor] >= 0,
//
// with standard errors from the Fisher information scaled by the residual variance.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/monitor.hpp"
#include "common/sea_parameters.hpp"
#include "identify/estimate/choice.hpp"
#include "identify/estimate/estimate.hpp"
#include "identify/fit/start_options.hpp"
#include "identify/logs/trial.hpp"
#include "identify/rig/rig.hpp"
#include "identify/rollout/nuisance.hpp"

namespace ukemi::integrate {
enum class Method;
}

namespace ukemi::identify {

struct RigTerm;
struct RolloutOptions;
struct Weighting;
struct Sensitivity;

/// All five constants free, no nuisance terms; the table holds every term that can be fitted.
Terms<RigTerm> rig_choice();

struct FitOptions {
  Terms<RigTerm> terms = rig_choice();  ///< what is fitted; priors of shared terms only
  double huber = 0;                     ///< Huber's delta on each sample's residual [rad]; 0: squares
  enum class Weights { kEqual, kTrial } weights = Weights::kEqual;  ///< kTrial: 1 / each trial's own residual variance
  double accuracy = 1e-9;                                           ///< relative tolerance of the rollout
  std::optional<integrate::Method> method;  ///< of the rollout, for comparison; see RolloutOptions
  double max_step = kLongestStep;           ///< of the rollout [s]
  double escape = kEscape;                  ///< angle that ends a rollout [rad]; infinite for multi-turn trials
  int restarts = 10;                        ///< further starts where the residual stays far above the noise
  int explore = 0;         ///< starts in all, whatever the residual, to see which minima there are; 0: as few as needed
  int threads = 0;         ///< 0: all cores; without influence on the results
  std::uint64_t seed = 1;  ///< of the drawn starts
  int max_iterations = 200;  ///< of the solver, each start
  /// Whether the errors that the rig states add to the noise's covariance (Considered). For terms that are fitted they
  /// act as priors in any case.
  enum class Errors { kWhole, kNoiseOnly } errors = Errors::kWhole;
  StartOptions starts;  ///< how starts are drawn, and what they may cost
  Monitor monitor;      ///< progress in starts; if it stops the fit, the best so far is kept: Fit::interrupted
  RolloutOptions rollout() const;
  void validate() const;  ///< throws InputError
};

/// A minimum at which starts converged.
struct Minimum {
  SeaParameters<double> sea;
  double cost;  ///< like Fit::cost
  int found;    ///< number of starts that converged to it
};

struct TrialResult {
  std::string file;
  std::size_t samples = 0;
  double t_origin = 0;  ///< of the trial [s]
  /// Of the residuals of phi, phi_motor and torque (times angle_per_torque), as logged [rad]; NaN: the rollout failed.
  double rms = 0;
  double rms_rate = 0;                     ///< of the angles' residuals, differenced between samples [rad/s]
  double rms_torque = 0;                   ///< of the torque's residual [Nm]; 0 where none was logged
  double noise = 0;                        ///< the log's own noise [rad]
  std::vector<double> phi, phi_m, torque;  ///< predicted; empty where the rollout failed
  RolloutStatus status = RolloutStatus::kDone;
  std::shared_ptr<const Weighting> weighting;  ///< of its residuals in the fit; null: not known
};

struct Fit : Estimates {
  SeaParameters<double> sea;  ///< the result, tau_max and feedback included; without what a RigTerm::change does
  double rms = 0;             ///< unweighted, over every measured output [rad]; `cost` is E(U) [rad^2]
  bool identifiable = false;
  bool far_above_noise = false;  ///< the residual, beyond kFarAboveNoise: no constant is trusted
  bool flawed_logs = false;      ///< a gap in a hit, or a force of the wrong sign: no constant is trusted
  bool interrupted = false;      ///< by the monitor; this is the best fit so far
  std::vector<Minimum> minima;   ///< at which starts converged, the lowest first
  std::vector<TrialResult> trials;
  std::shared_ptr<const Sensitivity> sensitivity;  ///< at the minimum, if the rig states errors; else null
};

/// Fits the constants to the trials. Throws InputError for invalid arguments. Without `start` one is derived from the
/// rig and the trials. `base` gives what is not fitted: tau_max, feedback, stiffening, friction. A start at 0 is moved
/// off it. Numerical failure is reported, not thrown: see Fit::converged; if no start could be simulated, Fit::fitted
/// is empty. The force is used as each trial has it: see flatten_force_between_hits; its noise within the hits
/// (Trial::force_noise) weighs the residuals, see Weighting. The work is bounded for any logs: see StartOptions.
[[nodiscard]] Fit fit(const Rig& rig, const std::vector<Trial>& trials,
                      const std::optional<SeaParameters<double>>& start, const SeaParameters<double>& base,
                      const FitOptions& options = {});

/// The rig's motion for given constants (i_motor above 0) against the logs, nothing fitted. rms is 0 where nothing is
/// measured. `own`: nuisance values of each trial; empty: every trial starts at rest at its reference.
[[nodiscard]] Fit predict(const Rig& rig, const std::vector<Trial>& trials, const SeaParameters<double>& sea,
                          const FitOptions& options = {}, const std::vector<Nuisance<double>>& own = {});

/// The trials with the force between their samples linear or smooth (Trial::force_smooth), whichever gives the smaller
/// residuals at these constants; unchanged if none has a force, or one is smooth already.
[[nodiscard]] std::vector<Trial> with_nearer_force(const Rig& rig, const std::vector<Trial>& trials,
                                                   const SeaParameters<double>& sea, const FitOptions& options = {});

/// The input of a fit.
struct Experiment {
  const Rig& rig;
  const std::vector<Trial>& trials;
  FitOptions options;
  void validate(const Fit& fit) const;  ///< throws InputError, also where `fit` is not of these trials
};

}  // namespace ukemi::identify

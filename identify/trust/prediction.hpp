// Validation on trials that a fit did not use: whether the actuator's file predicts them within their noise and its
// own errors.
#pragma once

#include <limits>
#include <vector>

#include "common/actuator.hpp"
#include "identify/fit/fit.hpp"

namespace ukemi::identify {

/// The initial state of the predicted trials.
struct InitialState {
  enum class Kind {
    kAtReference,  ///< at rest at phi_ref, or at 0 without one
    kGiven,        ///< at rest at `angle`
    kFitted,       ///< angle and rate of each trial, fitted to it
  } kind = Kind::kAtReference;
  double angle = 0;  ///< of the output and the motor, the spring relaxed [rad]
};

/// The meaning of a factor: kHolds up to 1, kHoldsWithin up to kFarAboveNoise.
enum class Verdict { kHolds, kHoldsWithin, kDoesNotHold, kNotMeasured };
[[nodiscard]] Verdict verdict_of(double factor);

struct JudgedTrial {
  /// x: the factor on the noise and the constants' errors at which the trial's residual would have the probability
  /// kTestLevel over the number of trials. At most 1: it holds. NaN: too little is measured.
  double factor = std::numeric_limits<double>::quiet_NaN();
  /// Of each measured sample: half of the 95 % band about the prediction, from the noise and the constants' errors
  /// [rad, Nm]; empty where it was not measured.
  std::vector<double> phi, phi_m, torque;
};

/// A prediction, judged trial by trial.
struct Judgement {
  std::vector<JudgedTrial> trials;
  double factor = std::numeric_limits<double>::quiet_NaN();  ///< the largest of the trials'
  bool by_noise_alone = false;                               ///< the actuator's file holds no covariance
  Verdict verdict() const { return verdict_of(factor); }
};

struct Prediction {
  Fit fit;              ///< only the initial state is fitted, as nuisance, if requested
  Judgement judgement;  ///< see prediction_error; the derivatives are the rollout's, exact
};

/// `predict` of the experiment's trials, and the verdict on it. The noise is each log's own (TrialResult::noise), and
/// the force's (Trial::force_noise). `actuator` as it is mounted: its `sea` is simulated, its covariance
/// counts. Throws InputError for invalid arguments.
[[nodiscard]] Prediction predict(const Experiment& experiment, const Actuator& actuator,
                                 const InitialState& start = {});

}  // namespace ukemi::identify

// Trials replayed for given constants: predictions at the logs' samples, and their residuals.
#pragma once

#include <vector>

#include "identify/fit/fit.hpp"
#include "identify/fit/rig_terms.hpp"

namespace ukemi::identify {

[[nodiscard]] TrialResult replay(const Rig& rig, const PreparedTrial& prepared, const RolloutInputs<double>& inputs,
                                 const RolloutOptions& options);

/// phi, phi_motor, then torque by angle_per_torque, predicted minus measured, whitened but not weighted.
Eigen::VectorXd white_residuals(const Trial& log, const TrialResult& result);

/// Root mean square over all measurements, from rms(log, result) of each trial.
template <class Rms>
double pooled(const std::vector<TrialResult>& trials, const std::vector<Trial>& logs, Rms&& rms) {
  double sum = 0, n = 0;
  for (std::size_t m = 0; m < trials.size(); ++m) {
    const double count = double(logs[m].measurements()), v = rms(logs[m], trials[m]);
    sum += count * v * v, n += count;
  }
  return n > 0 ? std::sqrt(sum / n) : 0;
}
inline double raw_rms(const Trial&, const TrialResult& r) { return r.rms; }
/// rms of a trial's whitened residuals [rad].
double white_rms(const Trial& log, const TrialResult& result);

}  // namespace ukemi::identify

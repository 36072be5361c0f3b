#include "identify/fit/replay.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ukemi::identify {

TrialResult replay(const Rig& rig, const PreparedTrial& prepared, const RolloutInputs<double>& inputs,
                   const RolloutOptions& options) {
  const Trial& trial = *prepared.trial;
  TrialResult out{.file = trial.file, .samples = trial.samples(), .phi = {}, .phi_m = {}, .weighting = {}};
  out.noise = std::max(noise_level(trial.phi), noise_level(trial.phi_motor));
  out.status = rollout(rig, inputs.sea, inputs.nuisance, prepared, options, out.phi, out.phi_m);
  if (out.status != RolloutStatus::kDone) {
    out.phi.clear(), out.phi_m.clear();
    out.rms = std::numeric_limits<double>::quiet_NaN();
    return out;
  }
  double sum = 0, sum_of_rates = 0, rates = 0;
  for (const auto& [measured, predicted] : {std::pair(&trial.phi, &out.phi), {&trial.phi_motor, &out.phi_m}}) {
    const auto residual = [&](std::size_t i) { return (*predicted)[i] - (*measured)[i]; };
    for (std::size_t i = 0; i < measured->size(); ++i) sum += std::pow(residual(i), 2);
    for (std::size_t i = 1; i < measured->size(); ++i, ++rates)
      sum_of_rates += std::pow((residual(i) - residual(i - 1)) / (trial.t[i] - trial.t[i - 1]), 2);
  }
  if (trial.measurements() > 0) out.rms = std::sqrt(sum / double(trial.measurements()));
  if (rates > 0) out.rms_rate = std::sqrt(sum_of_rates / rates);
  return out;
}

Eigen::VectorXd white_residuals(const Trial& log, const TrialResult& r) {
  Eigen::VectorXd all(long(log.measurements()));
  long i = 0;
  for (std::size_t k = 0; k < log.phi.size(); ++k) all[i++] = r.phi[k] - log.phi[k];
  for (std::size_t k = 0; k < log.phi_motor.size(); ++k) all[i++] = r.phi_m[k] - log.phi_motor[k];
  r.weighting.whiten(all);
  return all;
}

double white_rms(const Trial& log, const TrialResult& r) {
  if (r.weighting.u.size() == 0) return r.rms;
  const Eigen::VectorXd all = white_residuals(log, r);
  return std::sqrt(all.squaredNorm() / double(all.size()));
}

}  // namespace ukemi::identify

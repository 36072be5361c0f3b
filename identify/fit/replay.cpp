#include "identify/fit/replay.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "identify/estimate/statistics.hpp"
#include "identify/fit/weighting.hpp"
#include "identify/logs/trial_checks.hpp"

namespace ukemi::identify {

namespace {

std::span<const double> span_of(const Eigen::VectorXd& x) { return {x.data(), std::size_t(x.size())}; }

/// phi, phi_motor, then torque by angle_per_torque; predicted minus measured [rad].
Eigen::VectorXd raw_residuals(const Trial& log, const TrialResult& r) {
  Eigen::VectorXd all(long(log.measurements()));
  long row = 0;
  const auto add = [&](const std::vector<double>& predicted, const std::vector<double>& measured, double unit) {
    for (std::size_t i = 0; i < measured.size(); ++i) all[row++] = unit * (predicted[i] - measured[i]);
  };
  add(r.phi, log.phi, 1), add(r.phi_m, log.phi_motor, 1), add(r.torque, log.torque, angle_per_torque(log));
  return all;
}

}  // namespace

TrialResult replay(const Rig& rig, const PreparedTrial& prepared, const RolloutInputs<double>& inputs,
                   const RolloutOptions& options) {
  const Trial& trial = *prepared.trial;
  TrialResult out{.file = trial.file,
                  .samples = trial.samples(),
                  .t_origin = trial.t_origin,
                  .phi = {},
                  .phi_m = {},
                  .torque = {},
                  .weighting = {}};
  out.noise = std::max(noise_level(trial.phi), noise_level(trial.phi_motor));
  out.status = rollout(rig, inputs.sea, inputs.nuisance, prepared, options, out.phi, out.phi_m, &out.torque);
  if (out.status != RolloutStatus::kDone) {
    out.phi.clear(), out.phi_m.clear(), out.torque.clear();
    out.rms = std::numeric_limits<double>::quiet_NaN();
    return out;
  }
  if (trial.measurements() > 0) out.rms = root_mean_square(span_of(raw_residuals(trial, out)));
  if (!trial.torque.empty()) {
    std::vector<double> error(trial.torque.size());
    std::transform(out.torque.begin(), out.torque.end(), trial.torque.begin(), error.begin(), std::minus());
    out.rms_torque = root_mean_square(error);
  }
  double sum_of_squares = 0, rates = 0;
  for (const auto& pair : {std::pair(&trial.phi, &out.phi), {&trial.phi_motor, &out.phi_m}})
    for (std::size_t i = 1; i < pair.first->size(); ++i, ++rates) {
      const auto residual = [&](std::size_t k) { return (*pair.second)[k] - (*pair.first)[k]; };
      sum_of_squares += std::pow((residual(i) - residual(i - 1)) / (trial.t[i] - trial.t[i - 1]), 2);
    }
  if (rates > 0) out.rms_rate = std::sqrt(sum_of_squares / rates);
  return out;
}

Eigen::VectorXd white_residuals(const Trial& log, const TrialResult& r) {
  Eigen::VectorXd all = raw_residuals(log, r);
  weighting_of(r).whiten(all);
  return all;
}

double white_rms(const Trial& log, const TrialResult& r) {
  if (weighting_of(r).u.size() == 0) return r.rms;
  return root_mean_square(span_of(white_residuals(log, r)));
}

}  // namespace ukemi::identify

#include "identify/fit/weighting.hpp"

#include <algorithm>
#include <cmath>

#include "common/decompositions.hpp"
#include "identify/logs/hits.hpp"
#include "identify/logs/trial_checks.hpp"

namespace ukemi::identify {

namespace {

/// phi, phi_m and torque by angle_per_torque, where they were measured; empty where the rollout fails.
Eigen::VectorXd predicted(const Rig& rig, const SeaParameters<double>& sea, const Nuisance<double>& nuisance,
                          const Trial& trial, const RolloutOptions& options) {
  std::vector<double> phi, phi_m, torque;
  if (rollout(rig, sea, nuisance, PreparedTrial(trial), options, phi, phi_m, &torque) != RolloutStatus::kDone)
    return {};
  if (trial.phi.empty()) phi.clear();
  if (!trial.phi_motor.empty()) phi.insert(phi.end(), phi_m.begin(), phi_m.end());
  if (const double unit = angle_per_torque(trial); unit > 0)
    for (const double tau : torque) phi.push_back(unit * tau);
  return Eigen::Map<const Eigen::VectorXd>(phi.data(), long(phi.size()));
}

}  // namespace

Weighting force_noise_weighting(const Rig& rig, const SeaParameters<double>& sea, const Nuisance<double>& nuisance,
                                const Trial& trial, double angle_noise, const RolloutOptions& options) {
  constexpr std::size_t kParts = 8, kMaxHits = 4;
  constexpr double kNegligible = 1e-3;  // variance beside that of the angle noise
  Weighting out;
  if (!(trial.force_noise > 0 && angle_noise > 0)) return out;
  const Eigen::VectorXd nominal = predicted(rig, sea, nuisance, trial, options);
  if (nominal.size() == 0) return out;
  std::vector<LoggedHit> longest = hits(trial, trial.force_noise, trial.force_rest);
  std::sort(longest.begin(), longest.end(),
            [](const LoggedHit& a, const LoggedHit& b) { return a.last - a.first > b.last - b.first; });
  if (longest.size() > kMaxHits) longest.resize(kMaxHits);  // the longest carry the noise
  std::vector<Eigen::VectorXd> responses;
  for (const LoggedHit& h : longest) {
    const std::size_t samples = h.last + 1 - h.first, parts = std::min(kParts, samples);
    for (std::size_t p = 0; p < parts; ++p) {
      const std::size_t from = h.first + samples * p / parts, to = h.first + samples * (p + 1) / parts;
      Trial log = trial;
      for (std::size_t i = from; i < to; ++i) log.force[i] += trial.force_noise / std::sqrt(double(to - from));
      const Eigen::VectorXd perturbed = predicted(rig, sea, nuisance, log, options);
      if (perturbed.size() == 0) return out;
      responses.push_back((perturbed - nominal) / angle_noise);
    }
  }
  if (responses.empty()) return out;
  Eigen::MatrixXd directions(nominal.size(), long(responses.size()));
  for (std::size_t k = 0; k < responses.size(); ++k) directions.col(long(k)) = responses[k];
  const SymmetricEigen eigen = symmetric_eigen(directions.transpose() * directions);
  long first = 0;
  while (first < eigen.values.size() && eigen.values[first] < kNegligible) ++first;
  const long count = eigen.values.size() - first;
  if (count == 0) return out;
  const Eigen::ArrayXd s_squared = eigen.values.tail(count);
  out.u = directions * eigen.vectors.rightCols(count) * s_squared.rsqrt().matrix().asDiagonal();
  out.shrink = 1 - (1 + s_squared).rsqrt();
  return out;
}

}  // namespace ukemi::identify

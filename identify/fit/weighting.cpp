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

Weighting weigh_force_noise(const Rig& rig, const SeaParameters<double>& sea, const Nuisance<double>& nuisance,
                            const Trial& trial, double angle_noise, const RolloutOptions& options) {
  constexpr std::size_t kParts = 8, kMostHits = 4;
  constexpr double kNothing = 1e-3;  // variance beside that of the angle noise
  Weighting out;
  if (!(trial.force_noise > 0 && angle_noise > 0)) return out;
  const Eigen::VectorXd at = predicted(rig, sea, nuisance, trial, options);
  if (at.size() == 0) return out;
  std::vector<LoggedHit> all = hits(trial, trial.force_noise, trial.force_rest);
  std::sort(all.begin(), all.end(),
            [](const LoggedHit& a, const LoggedHit& b) { return a.last - a.first > b.last - b.first; });
  if (all.size() > kMostHits) all.resize(kMostHits);  // the longest carry the noise
  std::vector<Eigen::VectorXd> moved;
  for (const LoggedHit& h : all) {
    const std::size_t samples = h.last + 1 - h.first, parts = std::min(kParts, samples);
    for (std::size_t p = 0; p < parts; ++p) {
      const std::size_t from = h.first + samples * p / parts, to = h.first + samples * (p + 1) / parts;
      Trial off = trial;
      for (std::size_t i = from; i < to; ++i) off.force[i] += trial.force_noise / std::sqrt(double(to - from));
      const Eigen::VectorXd there = predicted(rig, sea, nuisance, off, options);
      if (there.size() == 0) return out;
      moved.push_back((there - at) / angle_noise);
    }
  }
  if (moved.empty()) return out;
  Eigen::MatrixXd ways(at.size(), long(moved.size()));
  for (std::size_t k = 0; k < moved.size(); ++k) ways.col(long(k)) = moved[k];
  const SymmetricEigen eigen = symmetric_eigen(ways.transpose() * ways);
  long first = 0;
  while (first < eigen.values.size() && eigen.values[first] < kNothing) ++first;
  const long count = eigen.values.size() - first;
  if (count == 0) return out;
  const Eigen::ArrayXd squares = eigen.values.tail(count);
  out.u = ways * eigen.vectors.rightCols(count) * squares.rsqrt().matrix().asDiagonal();
  out.shrink = 1 - (1 + squares).rsqrt();
  return out;
}

}  // namespace ukemi::identify

// How a trial's residuals are weighed, and made white where the load cell's noise colours them.
#pragma once

#include <Eigen/Core>

#include "identify/fit/fit.hpp"
#include "identify/rollout/rollout.hpp"

namespace ukemi::identify {

/// Residuals r count as weight W r. W is the inverse root of their covariance in units of the angle noise's variance,
///
///     1 + sum_k s_k^2 u_k u_k',   W = 1 - sum_k (1 - 1 / sqrt(1 + s_k^2)) u_k u_k',
///
/// where u_k s_k are the principal ways in which force noise moves the angles; without it W = 1.
struct Weighting {
  double weight = 1;
  Eigen::MatrixXd u;       ///< measurements x ways, orthonormal; empty where the force has no noise
  Eigen::VectorXd shrink;  ///< 1 - 1 / sqrt(1 + s_k^2)

  /// Makes residuals, or their derivatives, white; without the weight.
  void whiten(Eigen::Ref<Eigen::VectorXd> r) const {
    if (u.size() > 0) r -= u * shrink.cwiseProduct(u.transpose() * r);
  }
};

/// Of a trial of a fit.
inline Weighting weighting_of(const TrialResult& r) { return r.weighting ? *r.weighting : Weighting{}; }

/// The weighting by the noise of the trial's force (Trial::force_noise) at given constants, first order: each hit is
/// cut in at most 8 parts, each part's impulse is off by noise sqrt(samples) interval, and the rollout says how far
/// that moves the angles, which have white noise of `angle_noise` [rad, > 0] of their own. Without effect where a
/// rollout fails.
Weighting weigh_force_noise(const Rig& rig, const SeaParameters<double>& sea, const Nuisance<double>& nuisance,
                            const Trial& trial, double angle_noise, const RolloutOptions& options);

}  // namespace ukemi::identify

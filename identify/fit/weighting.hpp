// How a trial's residuals are weighted, and whitened where the load cell's noise colours them.
#pragma once

#include <Eigen/Core>

#include "identify/fit/fit.hpp"
#include "identify/rollout/rollout.hpp"

namespace ukemi::identify {

/// Residuals r count as weight W r. W is the inverse root of their covariance in units of the angle noise's variance,
///
///     1 + sum_k s_k^2 u_k u_k',   W = 1 - sum_k (1 - 1 / sqrt(1 + s_k^2)) u_k u_k',
///
/// where u_k s_k are the principal directions in which force noise moves the angles; without it W = 1.
struct Weighting {
  double weight = 1;
  Eigen::MatrixXd u;       ///< measurements x directions, orthonormal; empty where the force has no noise
  Eigen::VectorXd shrink;  ///< 1 - 1 / sqrt(1 + s_k^2)

  /// Whitens residuals, or their derivatives; does not apply `weight`.
  void whiten(Eigen::Ref<Eigen::VectorXd> r) const {
    if (u.size() > 0) r -= u * shrink.cwiseProduct(u.transpose() * r);
  }
};

/// The weighting of a fitted trial; neutral where it is not known.
inline Weighting weighting_of(const TrialResult& r) { return r.weighting ? *r.weighting : Weighting{}; }

/// The weighting by the noise of the trial's force (Trial::force_noise) at given constants, to first order: each hit is
/// cut into at most 8 parts, each part's impulse is perturbed by noise * sqrt(samples) * interval, and a rollout gives
/// the response of the angles, whose own white noise is `angle_noise` [rad, > 0]. Neutral where a rollout fails.
Weighting force_noise_weighting(const Rig& rig, const SeaParameters<double>& sea, const Nuisance<double>& nuisance,
                                const Trial& trial, double angle_noise, const RolloutOptions& options);

}  // namespace ukemi::identify

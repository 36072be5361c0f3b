// Whether a prediction holds on measurements that its constants were not fitted to: its residual against their noise
// and against the constants' own errors.
#pragma once

#include <Eigen/Core>

namespace ukemi::identify {

/// What is known of a prediction of n measurements. Units are the residual's.
struct PredictionCase {
  Eigen::VectorXd residual;      ///< r, predicted minus measured; n
  Eigen::MatrixXd by_constants;  ///< J, its derivatives by the constants; n x k
  Eigen::MatrixXd covariance;    ///< P of the constants; k x k. k = 0: they are taken as exact
  Eigen::MatrixXd by_fitted;     ///< derivatives by what was fitted to these same measurements; n x l, l may be 0
  double noise = 1;              ///< sigma, standard deviation of each measurement, > 0
  double noise_variance = 0;     ///< of sigma^2 as it was estimated, over sigma^4, times n; 0: sigma is exact
};

struct PredictionError {
  /// x: the factor on all errors, sigma and those of the constants, at which a residual like this one would have the
  /// probability `level`. At most 1: the prediction holds.
  double factor = 0;
  Eigen::VectorXd std;  ///< of each measurement about its prediction; n
};

/// Where the prediction is right, M r has covariance S = sigma^2 M + M J P J' M, M the projector off `by_fitted`, and
///
///     d^2 = r' S^+ r = (|M r|^2 - b' (sigma^2 + A' A)^-1 b) / sigma^2,   A = M J P^1/2,   b = A' r,
///
/// is chi-squared with n - rank(by_fitted) degrees of freedom, fewer where sigma is an estimate. x^2 = d^2 over its
/// value at `level` in (0, 1). The part that the constants' errors can explain is weighed by them, the rest by the
/// noise.
[[nodiscard]] PredictionError prediction_error(const PredictionCase& prediction, double level);

}  // namespace ukemi::identify

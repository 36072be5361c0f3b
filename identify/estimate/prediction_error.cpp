#include "identify/estimate/prediction_error.hpp"

#include <cmath>

#include "common/decompositions.hpp"
#include "identify/estimate/statistics.hpp"

namespace ukemi::identify {

PredictionError prediction_error(const PredictionCase& p, double level) {
  using Eigen::MatrixXd, Eigen::VectorXd;
  const long k = p.covariance.rows();
  VectorXd r = p.residual;
  MatrixXd a(r.size(), k);
  if (k > 0) {
    // Constants in their own standard deviations, whatever their units.
    const VectorXd unit = p.covariance.diagonal().cwiseMax(1e-300).cwiseSqrt();
    const SymmetricEigen eigen =
        symmetric_eigen(unit.cwiseInverse().asDiagonal() * p.covariance * unit.cwiseInverse().asDiagonal());
    a = p.by_constants * unit.asDiagonal() * eigen.vectors * eigen.values.cwiseMax(0).cwiseSqrt().asDiagonal();
  }
  double degrees = double(r.size());
  if (p.by_fitted.cols() > 0) {
    const LeastNorm own(p.by_fitted);
    r -= p.by_fitted * own.solve(r);
    if (k > 0) a -= p.by_fitted * own.solve(a);
    degrees -= double(own.rank());
  }
  const double variance = p.noise * p.noise;
  double distance = r.squaredNorm();
  if (k > 0) {
    const VectorXd b = a.transpose() * r;
    const MatrixXd inner = MatrixXd::Identity(k, k) * variance + a.transpose() * a;
    distance -= b.dot(LeastNorm(inner).solve(b).col(0));
  }
  PredictionError out;
  out.std = (a.rowwise().squaredNorm().array() + variance).sqrt();
  // d^2 / n has the variance of a chi-squared mean, 2 / n, and that of sigma^2.
  const double effective = 2 * degrees / (2 + p.noise_variance);
  if (degrees > 0)
    out.factor =
        std::sqrt(std::max(distance, 0.0) / variance / degrees * effective / chi_squared_quantile(level, effective));
  return out;
}

}  // namespace ukemi::identify

// Covariance matrix adaptation, for valleys that run across the variables: a normal distribution whose mean, size and
// shape follow the better half of each generation. Source: Hansen, "The CMA evolution strategy: a tutorial",
// arXiv:1604.00772 (2016), without negative weights. Points outside of the cube are moved to its nearest face, and
// count as samples there.
#pragma once

#include <span>

#include "common/random.hpp"
#include "landing/search/objective.hpp"

namespace ukemi::landing {

class CovarianceAdaptation {
 public:
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxVariables, kMaxVariables>;

  /// Restarts at a mean, `sigma` as a fraction of the cube, with `lambda` points a generation (>= 4).
  void start(const Coordinates& mean, double sigma, int lambda);
  /// Draws a generation; sets u alone.
  void sample(Random& random, std::span<Candidate> points) const;
  /// Sorts a generation, the best first, and updates the distribution from it. Returns a value above which a point of
  /// the next generation is likely to have no weight.
  double update(std::span<Candidate> points);
  /// The largest standard deviation, as a fraction of the cube.
  double largest_deviation() const { return sigma_ * d_.maxCoeff(); }

 private:
  Coordinates mean_, p_sigma_, p_c_, d_;  ///< evolution paths; square roots of the eigenvalues of C
  Matrix c_, b_;                          ///< C = B diag(d)^2 B^T, its eigenvectors; the covariance is sigma^2 C
  Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 64, 1> weights_;
  double sigma_ = 0, mu_eff_ = 0;
  long generations_ = 0;
};

}  // namespace ukemi::landing

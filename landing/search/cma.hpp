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
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMostVariables, kMostVariables>;

  /// Restarts about a point, `size` in parts of the cube, with a number of points a generation (>= 4).
  void start(const Coordinates& mean, double size, int generation);
  /// A generation's points; their bounds are the caller's.
  void sample(Random& random, std::span<Candidate> points) const;
  /// Updates the distribution from them, the best first.
  void learn(std::span<const Candidate> sorted);
  /// The distribution's largest standard deviation, in parts of the cube.
  double widest() const { return size_ * root_.maxCoeff(); }

 private:
  Coordinates mean_, path_size_, path_shape_, root_;  ///< root_: of the covariance's eigenvalues
  Matrix shape_, axes_;                               ///< the covariance by size_^2, its eigenvectors
  Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 64, 1> weights_;
  double size_ = 0, effective_ = 0;
  long generations_ = 0;
};

}  // namespace ukemi::landing

#include "landing/search/cma.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace ukemi::landing {

void CovarianceAdaptation::start(const Coordinates& mean, double size, int generation) {
  const auto n = mean.size();
  const int parents = generation / 2;
  mean_ = mean, size_ = size, generations_ = 0;
  path_size_ = path_shape_ = Coordinates::Zero(n);
  root_ = Coordinates::Ones(n);
  shape_ = axes_ = Matrix::Identity(n, n);
  weights_.resize(parents);
  for (int i = 0; i < parents; ++i) weights_[i] = std::log(0.5 * (generation + 1)) - std::log(i + 1.0);
  weights_ /= weights_.sum();
  effective_ = 1 / weights_.squaredNorm();
}

void CovarianceAdaptation::sample(Random& random, std::span<Candidate> points) const {
  for (Candidate& p : points) {
    Coordinates z(mean_.size());
    for (double& x : z) x = random.normal();
    p.u = (mean_ + size_ * (axes_ * root_.cwiseProduct(z))).cwiseMax(0).cwiseMin(1);
  }
}

void CovarianceAdaptation::learn(std::span<const Candidate> sorted) {
  const double n = double(mean_.size()), mu = effective_;
  const double c_size = (mu + 2) / (n + mu + 5), c_shape = (4 + mu / n) / (n + 4 + 2 * mu / n),
               c_one = 2 / ((n + 1.3) * (n + 1.3) + mu),
               c_rank = std::min(1 - c_one, 2 * (mu - 2 + 1 / mu) / ((n + 2) * (n + 2) + mu)),
               damping = 1 + 2 * std::max(0.0, std::sqrt((mu - 1) / (n + 1)) - 1) + c_size,
               expected = std::sqrt(n) * (1 - 1 / (4 * n) + 1 / (21 * n * n));  // of a normal vector's length
  const Coordinates before = mean_;
  mean_.setZero();
  for (int i = 0; i < int(weights_.size()); ++i) mean_ += weights_[i] * sorted[std::size_t(i)].u;
  const Coordinates step = (mean_ - before) / size_;
  path_size_ = (1 - c_size) * path_size_ +
               std::sqrt(c_size * (2 - c_size) * mu) * (axes_ * (axes_.transpose() * step).cwiseQuotient(root_));
  ++generations_;
  const double length = path_size_.norm(), started = 1 - std::pow(1 - c_size, 2.0 * double(generations_));
  const bool stalled = length / std::sqrt(started) >= (1.4 + 2 / (n + 1)) * expected;
  path_shape_ = (1 - c_shape) * path_shape_;
  if (!stalled) path_shape_ += std::sqrt(c_shape * (2 - c_shape) * mu) * step;
  const double lost = stalled ? c_one * c_shape * (2 - c_shape) : 0;
  shape_ = (1 - c_one - c_rank + lost) * shape_ + c_one * path_shape_ * path_shape_.transpose();
  for (int i = 0; i < int(weights_.size()); ++i) {
    const Coordinates y = (sorted[std::size_t(i)].u - before) / size_;
    shape_ += c_rank * weights_[i] * y * y.transpose();
  }
  size_ *= std::exp(std::min(1.0, c_size / damping * (length / expected - 1)));
  Eigen::SelfAdjointEigenSolver<Matrix> eigen(shape_);
  axes_ = eigen.eigenvectors();
  root_ = eigen.eigenvalues().cwiseMax(1e-20).cwiseSqrt();
}

}  // namespace ukemi::landing

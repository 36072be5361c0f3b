#include "landing/search/cma.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace ukemi::landing {

void CovarianceAdaptation::start(const Coordinates& mean, double sigma, int lambda) {
  const auto n = mean.size();
  const int parents = lambda / 2;
  mean_ = mean, sigma_ = sigma, generations_ = 0;
  p_sigma_ = p_c_ = Coordinates::Zero(n);
  d_ = Coordinates::Ones(n);
  c_ = b_ = Matrix::Identity(n, n);
  weights_.resize(parents);
  for (int i = 0; i < parents; ++i) weights_[i] = std::log(0.5 * (lambda + 1)) - std::log(i + 1.0);
  weights_ /= weights_.sum();
  mu_eff_ = 1 / weights_.squaredNorm();
}

void CovarianceAdaptation::sample(Random& random, std::span<Candidate> points) const {
  for (Candidate& p : points) {
    Coordinates z(mean_.size());
    for (double& x : z) x = random.normal();
    p.u = (mean_ + sigma_ * (b_ * d_.cwiseProduct(z))).cwiseMax(0).cwiseMin(1);
  }
}

double CovarianceAdaptation::update(std::span<Candidate> points) {
  std::sort(points.begin(), points.end());
  const double n = double(mean_.size()), mu = mu_eff_;
  const double c_sigma = (mu + 2) / (n + mu + 5), c_c = (4 + mu / n) / (n + 4 + 2 * mu / n),
               c_1 = 2 / ((n + 1.3) * (n + 1.3) + mu),
               c_mu = std::min(1 - c_1, 2 * (mu - 2 + 1 / mu) / ((n + 2) * (n + 2) + mu)),
               damping = 1 + 2 * std::max(0.0, std::sqrt((mu - 1) / (n + 1)) - 1) + c_sigma,
               expected_norm = std::sqrt(n) * (1 - 1 / (4 * n) + 1 / (21 * n * n));  // E|N(0, I)|
  const Coordinates old_mean = mean_;
  mean_.setZero();
  for (int i = 0; i < int(weights_.size()); ++i) mean_ += weights_[i] * points[std::size_t(i)].u;
  const Coordinates step = (mean_ - old_mean) / sigma_;
  p_sigma_ = (1 - c_sigma) * p_sigma_ +
             std::sqrt(c_sigma * (2 - c_sigma) * mu) * (b_ * (b_.transpose() * step).cwiseQuotient(d_));
  ++generations_;
  const double norm = p_sigma_.norm(), bias = 1 - std::pow(1 - c_sigma, 2.0 * double(generations_));
  const bool stalled = norm / std::sqrt(bias) >= (1.4 + 2 / (n + 1)) * expected_norm;
  p_c_ = (1 - c_c) * p_c_;
  if (!stalled) p_c_ += std::sqrt(c_c * (2 - c_c) * mu) * step;
  const double variance_loss = stalled ? c_1 * c_c * (2 - c_c) : 0;
  c_ = (1 - c_1 - c_mu + variance_loss) * c_ + c_1 * p_c_ * p_c_.transpose();
  for (int i = 0; i < int(weights_.size()); ++i) {
    const Coordinates y = (points[std::size_t(i)].u - old_mean) / sigma_;
    c_ += c_mu * weights_[i] * y * y.transpose();
  }
  sigma_ *= std::exp(std::min(1.0, c_sigma / damping * (norm / expected_norm - 1)));
  Eigen::SelfAdjointEigenSolver<Matrix> eigen(c_);
  b_ = eigen.eigenvectors();
  d_ = eigen.eigenvalues().cwiseMax(1e-20).cwiseSqrt();
  constexpr double kSlack = 1.3;
  const double median = points[points.size() / 2].value;
  return median < kNoMotion ? kSlack * median : kNoMotion;
}

}  // namespace ukemi::landing

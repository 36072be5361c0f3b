#include "landing/scatter/sampler.hpp"

#include <boost/math/special_functions/erf.hpp>
#include <cmath>
#include <numbers>

#include "common/checks.hpp"
#include "common/csv.hpp"
#include "common/decompositions.hpp"
#include "common/error.hpp"
#include "common/random.hpp"
#include "landing/scatter/sobol.hpp"

namespace ukemi::landing {

double truncated_normal(double u) {
  constexpr double kLimit = 3;
  static const double tail = 0.5 * std::erfc(kLimit / std::numbers::sqrt2);
  using namespace boost::math::policies;
  constexpr policy<promote_double<false>> kDouble;  // long double stops a start under valgrind
  return std::numbers::sqrt2 * boost::math::erf_inv(2 * (tail + u * (1 - 2 * tail)) - 1, kDouble);
}

namespace {

constexpr long kMaxPoints = 1'000'000'000;

/// R with R R^T = C.
Eigen::MatrixXd root_of(const Eigen::MatrixXd& c) {
  constexpr double kRounding = 1e-9;
  // Constants differ by powers of ten: negative eigenvalues are tested on the correlations.
  const Eigen::VectorXd std = c.diagonal().cwiseMax(0).cwiseSqrt();
  const Eigen::VectorXd inverse = std.unaryExpr([](double x) { return x > 0 ? 1 / x : 0; });
  const SymmetricEigen eigen = symmetric_eigen(inverse.asDiagonal() * c * inverse.asDiagonal());
  if (!c.allFinite() || (c.diagonal().array() < 0).any() || eigen.values.minCoeff() < -kRounding)
    throw InputError("covariance: its smallest eigenvalue is " + shortest(eigen.values.minCoeff()) +
                     " where its variances are 1: a positive semidefinite matrix is needed");
  return std.asDiagonal() * eigen.vectors * eigen.values.cwiseMax(0).cwiseSqrt().asDiagonal();
}

}  // namespace

void Sampler::add(const std::string& name, int count, Eigen::MatrixXd root) {
  blocks_.push_back({dimension_, std::move(root)});
  groups_.push_back({name, dimension_, count});
  dimension_ += count;
}
void Sampler::normal(const std::string& name, double deviation, int count) {
  check_not_negative("deviation", deviation), check_count("count", count, 1, 1000);
  add(name, count, deviation * Eigen::MatrixXd::Identity(count, count));
}
void Sampler::correlated(const std::string& name, const Eigen::MatrixXd& covariance, double factor) {
  check_not_negative("factor", factor);
  add(name, int(covariance.rows()), factor * root_of(covariance));
}
void Sampler::uniform(const std::string& name, int count) {
  check_count("count", count, 1, 1000);
  add(name, count, {});
}

std::vector<double> Sampler::at(std::span<const double> u) const {
  if (u.size() != std::size_t(dimension_))
    throw InputError("drop: " + std::to_string(u.size()) + " coordinates: " + std::to_string(dimension_) +
                     " are needed");
  for (const double x : u)
    if (!(x >= 0 && x <= 1)) throw InputError("drop: coordinate " + shortest(x) + ": 0 to 1 is needed");
  std::vector<double> out(u.size());
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const auto first = std::size_t(blocks_[b].first), count = std::size_t(groups_[b].count);
    if (blocks_[b].root.size() == 0) {
      for (std::size_t i = first; i < first + count; ++i) out[i] = 2 * u[i] - 1;
      continue;
    }
    Eigen::VectorXd normal = Eigen::VectorXd::Zero(long(count));
    for (std::size_t i = 0; i < count; ++i) normal[long(i)] = truncated_normal(u[first + i]);
    Eigen::Map<Eigen::VectorXd>(out.data() + first, long(count)) = blocks_[b].root * normal;
  }
  return out;
}

std::vector<double> Sampler::even(long count, std::uint64_t seed, long first) const {
  check_count("drops", count, 0, kMaxPoints), check_count("first", first, 0, kMaxPoints);
  return dimension_ > 0 ? ScrambledSobol(dimension_, seed).points(count, first) : std::vector<double>();
}

std::vector<double> Sampler::independent(long count, std::uint64_t seed) const {
  check_count("drops", count, 0, kMaxPoints);
  std::vector<double> out;
  out.reserve(std::size_t(count) * std::size_t(dimension_));
  for (long n = 0; n < count; ++n) {
    Random random(seed, std::uint64_t(n));
    for (int k = 0; k < dimension_; ++k) out.push_back(random.uniform());
  }
  return out;
}

}  // namespace ukemi::landing

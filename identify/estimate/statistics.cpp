#include "identify/estimate/statistics.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <unsupported/Eigen/SpecialFunctions>

#include "common/uncertainty.hpp"

namespace ukemi::identify {

double chi_squared_tail(double x, double degrees) {
  if (!(x > 0)) return 1;
  return Eigen::numext::igammac(degrees / 2, x / 2);
}

double chi_squared_quantile(double level, double degrees) {
  double low = 0, high = degrees;
  while (chi_squared_tail(high, degrees) > level) high *= 2;
  while (high - low > 1e-12 * high) {
    const double middle = low + (high - low) / 2;
    (chi_squared_tail(middle, degrees) > level ? low : high) = middle;
  }
  return high;
}

std::vector<bool> holm(const std::vector<double>& p, double level) {
  std::vector<std::size_t> order(p.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return p[a] < p[b]; });
  std::vector<bool> rejected(p.size(), false);
  for (std::size_t k = 0; k < order.size() && p[order[k]] < level / double(p.size() - k); ++k)
    rejected[order[k]] = true;
  return rejected;
}

double at_bound_tail(double ratio, int terms) {
  if (!(ratio > 0)) return 1;
  double sum = 0, choose = 1;
  for (int k = 0; k <= terms; ++k) {
    if (k > 0) sum += choose * chi_squared_tail(ratio, k);
    choose *= double(terms - k) / (k + 1);
  }
  return std::ldexp(sum, -terms);
}

double spread_from_bound(double beyond) {
  constexpr double kFar = 30;  // from there on the truncated distribution is exponential
  if (beyond > kFar) return std::sqrt(2.0) / beyond;
  const double density = std::exp(-beyond * beyond / 2) * std::sqrt(2 / std::numbers::pi),
               tail = std::erfc(beyond / std::sqrt(2.0));
  return std::sqrt(1 + beyond * beyond - beyond * density / tail);
}

double ljung_box(const std::vector<double>& x, int lags) {
  const std::size_t n = x.size();
  const double square = lagged_product(x, 0);
  if (!(square > 0) || n <= 2 * std::size_t(lags)) return 0;
  double q = 0;
  for (std::size_t lag = 1; lag <= std::size_t(lags); ++lag) {
    const double correlation = lagged_product(x, lag) / square;
    q += correlation * correlation / double(n - lag);
  }
  return double(n) * double(n + 2) * q;
}

double lagged_product(std::span<const double> x, std::size_t lag) {
  return std::inner_product(x.begin() + long(lag), x.end(), x.begin(), 0.0);
}

double root_mean_square(std::span<const double> x) { return std::sqrt(lagged_product(x, 0) / double(x.size())); }

Moments moments(const std::vector<double>& x) {
  Moments out;
  const double n = double(x.size());
  double mean = 0;
  for (const double v : x) mean += v / n;
  double second = 0, third = 0, fourth = 0;
  for (const double v : x) {
    const double d = v - mean;
    second += d * d / n, third += d * d * d / n, fourth += d * d * d * d / n;
  }
  if (!(second > 0)) return out;
  out.count = n;
  out.skewness = third / std::pow(second, 1.5);
  out.kurtosis = fourth / (second * second) - 3;
  return out;
}

double jarque_bera(const Moments& m) { return m.count * (m.skewness * m.skewness / 6 + m.kurtosis * m.kurtosis / 24); }

double t_quantile_975(long dof) {
  // Cornish-Fisher expansion of Student's t about the normal quantile; exact enough (1e-3) from 3 degrees of freedom
  // on.
  constexpr double z = kNormal975;
  if (dof < 3) return dof == 2 ? 4.302652729911275 : 12.706204736432095;
  const double n = double(dof), z3 = z * z * z, z5 = z3 * z * z, z7 = z5 * z * z;
  return z + (z3 + z) / (4 * n) + (5 * z5 + 16 * z3 + 3 * z) / (96 * n * n) +
         (3 * z7 + 19 * z5 + 17 * z3 - 15 * z) / (384 * n * n * n);
}

}  // namespace ukemi::identify

#include "identify/statistics.hpp"

#include <cmath>

namespace ukemi::identify {

double chi_squared_tail(double x, double degrees) {
  if (!(x > 0)) return 1;
  // The regularised incomplete gamma function Q(a, z): by its series below a + 1, by Lentz' continued fraction above.
  const double a = degrees / 2, z = x / 2;
  constexpr double kPrecision = 1e-15;
  const double front = std::exp(a * std::log(z) - z - std::lgamma(a));
  if (z < a + 1) {
    double term = 1 / a, sum = term;
    for (double n = a + 1; term > kPrecision * sum; ++n) sum += term *= z / n;
    return 1 - front * sum;
  }
  constexpr double kTiny = 1e-300;
  double b = z + 1 - a, c = 1 / kTiny, d = 1 / b, f = d;
  for (int n = 1; n < 10'000; ++n) {
    const double numerator = -n * (n - a);
    b += 2;
    d = numerator * d + b, c = b + numerator / c;
    if (std::abs(d) < kTiny) d = kTiny;
    if (std::abs(c) < kTiny) c = kTiny;
    d = 1 / d;
    f *= c * d;
    if (std::abs(c * d - 1) < kPrecision) break;
  }
  return front * f;
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

double ljung_box(const std::vector<double>& x, int lags) {
  const std::size_t n = x.size();
  double square = 0;
  for (const double v : x) square += v * v;
  if (!(square > 0) || n <= 2 * std::size_t(lags)) return 0;
  double q = 0;
  for (std::size_t lag = 1; lag <= std::size_t(lags); ++lag) {
    double product = 0;
    for (std::size_t i = lag; i < n; ++i) product += x[i] * x[i - lag];
    q += (product / square) * (product / square) / double(n - lag);
  }
  return double(n) * double(n + 2) * q;
}

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

}  // namespace ukemi::identify

#include "landing/judge/sobol_indices.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/error.hpp"
#include "common/parallel.hpp"
#include "common/random.hpp"

namespace ukemi::landing {

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// The terms of each base point in the sums of the indices, a row a point: f and f^2 over A and B, then for each group
/// those of its first-order and total index; f minus the mean.
class Terms {
 public:
  Terms(std::span<const double> f_a, std::span<const double> f_b, std::span<const std::vector<double>> f_ab)
      : width_(2 + 2 * f_ab.size()) {
    std::vector<std::size_t> finite_points;
    double sum = 0;
    for (std::size_t i = 0; i < f_a.size(); ++i) {
      bool finite = std::isfinite(f_a[i]) && std::isfinite(f_b[i]);
      for (const std::vector<double>& f : f_ab) finite = finite && std::isfinite(f[i]);
      if (finite) finite_points.push_back(i), sum += f_a[i] + f_b[i];
    }
    const double mean = sum / double(2 * finite_points.size());
    rows_.reserve(finite_points.size() * width_);
    for (const std::size_t i : finite_points) {
      const double a = f_a[i] - mean, b = f_b[i] - mean;
      rows_.insert(rows_.end(), {a + b, a * a + b * b});
      for (const std::vector<double>& f : f_ab) {
        const double change = f[i] - mean - a;
        rows_.insert(rows_.end(), {b * change, change * change / 2});
      }
    }
  }

  std::size_t points() const { return rows_.size() / width_; }
  /// First-order and total index of each group over the points index(0), index(1), ... (bootstrap).
  template <class Index>
  std::vector<std::pair<double, double>> indices(Index&& index) const {
    std::vector<double> sums(width_, 0.0);
    const std::size_t n = points();
    for (std::size_t k = 0; k < n; ++k) {
      const double* row = rows_.data() + index(k) * width_;
      for (std::size_t j = 0; j < width_; ++j) sums[j] += row[j];
    }
    const double mean = sums[0] / double(2 * n), variance = sums[1] / double(2 * n) - mean * mean;
    std::vector<std::pair<double, double>> out;
    for (std::size_t j = 2; j < width_; j += 2)
      out.emplace_back(sums[j] / double(n) / variance, sums[j + 1] / double(n) / variance);
    return out;
  }
  bool varies() const {
    for (std::size_t j = 1; j < rows_.size(); j += width_)
      if (rows_[j] > 0) return true;
    return false;
  }

 private:
  std::size_t width_;
  std::vector<double> rows_;
};

/// 95 % percentile interval; draws in which nothing varied are excluded.
Interval interval(double value, std::vector<double> draws) {
  std::erase_if(draws, [](double x) { return !std::isfinite(x); });
  if (draws.empty()) return {value, kNaN, kNaN};
  std::sort(draws.begin(), draws.end());
  const auto at = [&](double part) { return draws[std::size_t(std::lround(part * double(draws.size() - 1)))]; };
  return {value, at(0.025), at(0.975)};
}

}  // namespace

std::vector<SobolIndex> sobol_indices(std::span<const double> f_a, std::span<const double> f_b,
                                      std::span<const std::vector<double>> f_ab, std::uint64_t seed, int threads) {
  constexpr int kDraws = 1000;
  const auto same_size = [&](const auto& f) { return f.size() == f_a.size(); };
  if (!same_size(f_b) || !std::all_of(f_ab.begin(), f_ab.end(), same_size))
    throw InputError("sobol: values of " + std::to_string(f_a.size()) + " points: all must be as many");
  const Terms terms(f_a, f_b, f_ab);
  const std::size_t n = terms.points();
  constexpr Interval kUnknown{kNaN, kNaN, kNaN};
  if (n < 2 || !terms.varies()) return std::vector<SobolIndex>(f_ab.size(), {kUnknown, kUnknown});
  const auto found = terms.indices([](std::size_t k) { return k; });
  std::vector<std::vector<std::pair<double, double>>> draws(kDraws);
  parallel_for(kDraws, threads, [&](int d) {
    Random random(seed, std::uint64_t(d));
    draws[std::size_t(d)] = terms.indices([&](std::size_t) { return std::size_t(random.uniform() * double(n)); });
  });
  std::vector<SobolIndex> out;
  for (std::size_t g = 0; g < found.size(); ++g) {
    std::vector<double> first, total;
    for (const auto& draw : draws) first.push_back(draw[g].first), total.push_back(draw[g].second);
    out.push_back({interval(found[g].first, first), interval(found[g].second, total)});
  }
  return out;
}

}  // namespace ukemi::landing

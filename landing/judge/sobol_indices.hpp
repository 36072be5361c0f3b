// Sobol's indices: the share of a variance that each group of uncertain numbers causes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace ukemi::landing {

/// A value with its 95 % interval.
struct Interval {
  double value, low, high;
};

/// Shares of the variance due to one group. The first-order indices sum to at most 1, the totals to at least 1.
struct SobolIndex {
  Interval first;  ///< first order: what would vanish, on average, if the group were known
  Interval total;  ///< with interactions: what would remain if all other groups were known
};

/// Indices from n base points of two independent sets A and B: f_a and f_b are the values at their points, f_ab[g]
/// those at the points of A with the numbers of group g from B. First order after Saltelli et al. 2010 (Table 2, b),
/// about the mean; total after Jansen 1999. Intervals: percentiles of 1000 bootstrap samples of the base points, drawn
/// from the seed; conservative for points of a Sobol sequence. Base points with a value that is not finite are
/// excluded. NaN where nothing varies or fewer than two points remain. Throws InputError for different numbers of
/// values. `threads` has no influence on the result.
std::vector<SobolIndex> sobol_indices(std::span<const double> f_a, std::span<const double> f_b,
                                      std::span<const std::vector<double>> f_ab, std::uint64_t seed, int threads = 0);

}  // namespace ukemi::landing

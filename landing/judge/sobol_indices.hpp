// How much of a value's variance each group of uncertain numbers brings: Sobol's indices.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace ukemi::landing {

/// A value with its 95 % interval.
struct Interval {
  double value, low, high;
};

/// Shares of the variance that one group brings. In sum the first are at most 1, the totals at least 1.
struct SobolIndex {
  Interval first;  ///< by itself: what would go, on average, if it were known
  Interval total;  ///< with what it does together with others: what would be left if all else were known
};

/// Indices by n base points of two independent sets A and B: f_a and f_b are the values at their points, f_ab[g] those
/// at the points of A with the numbers of group g from B. First order after Saltelli et al. 2010 (Table 2, b), about
/// the mean; total after Jansen 1999. Intervals: percentiles of 1000 bootstrap samples of the base points, drawn from
/// the seed; points of a Sobol sequence do better than they say. A base point with a value that is not finite is left
/// out. NaN where nothing varies or fewer than two points are left; values that are not as many as each
/// other: InputError. `threads` has no influence on the result.
std::vector<SobolIndex> sobol_indices(std::span<const double> f_a, std::span<const double> f_b,
                                      std::span<const std::vector<double>> f_ab, std::uint64_t seed, int threads = 0);

}  // namespace ukemi::landing

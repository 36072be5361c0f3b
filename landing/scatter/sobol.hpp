// Scrambled Sobol points: low discrepancy, and unbiased like random points.
#pragma once

#include <cstdint>
#include <vector>

namespace ukemi::landing {

/// The first points of Sobol's sequence (Boost's, by the direction numbers of Joe and Kuo 2008), the origin among them,
/// each coordinate scrambled on its own after Owen, by a hash (Burley, JCGT 9(4), 2020). Every power of two of them
/// has one point in each of as many equal slices of a coordinate. The same seed gives the same points.
class ScrambledSobol {
 public:
  /// 1 to some thousand dimensions.
  ScrambledSobol(int dimension, std::uint64_t seed);
  /// `count` points from point `first` on, concatenated, each coordinate in (0, 1).
  std::vector<double> points(long count, long first = 0) const;
  int dimension() const { return int(seeds_.size()); }

 private:
  std::vector<std::uint32_t> seeds_;  ///< of each coordinate's scrambling
};

}  // namespace ukemi::landing

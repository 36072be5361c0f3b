// The median of a sample.
#pragma once

#include <algorithm>
#include <vector>

namespace ukemi {

/// The upper median: of an even number of values the larger of the two in the middle. At least one value is needed.
inline double median(std::vector<double> x) {
  const auto middle = x.begin() + long(x.size() / 2);
  std::nth_element(x.begin(), middle, x.end());
  return *middle;
}

}  // namespace ukemi

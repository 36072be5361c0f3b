// The median of a sample.
#pragma once

#include <algorithm>
#include <vector>

namespace ukemi {

/// The value in the middle; of an even number of values the mean of the two there. At least one value is needed.
inline double median(std::vector<double> x) {
  const auto middle = x.begin() + long(x.size() / 2);
  std::nth_element(x.begin(), middle, x.end());
  return x.size() % 2 == 1 ? *middle : (*middle + *std::max_element(x.begin(), middle)) / 2;
}

}  // namespace ukemi

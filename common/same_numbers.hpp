#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace ukemi {

/// Whether two columns of logs hold the same numbers; empty cells, which are NaN, are alike.
inline bool same_numbers(const std::vector<double>& a, const std::vector<double>& b) {
  return std::ranges::equal(a, b, [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); });
}

}  // namespace ukemi

// Noise level and range of a column of a log.
#pragma once

#include <vector>

namespace ukemi {

/// Standard deviation of a column's measurement noise, from the median of its fourth differences [same unit]; the
/// signal must be slow against the sampling. A log that is mostly constant is taken as quantised: its smallest step /
/// sqrt(12). 0 for fewer than nine values.
double noise_level(const std::vector<double>& column);

/// The largest |x - from| of a column's values [same unit]; 0 for none.
double largest_deviation(const std::vector<double>& column, double from = 0);

}  // namespace ukemi

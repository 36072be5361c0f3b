#include "common/noise.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/median.hpp"

namespace ukemi {

double noise_level(const std::vector<double>& x) {
  if (x.size() < 9) return 0;
  std::vector<double> d(x.size() - 4);
  for (std::size_t i = 0; i + 4 < x.size(); ++i)
    d[i] = std::abs(x[i] - 4 * x[i + 1] + 6 * x[i + 2] - 4 * x[i + 3] + x[i + 4]);
  const double white =
      median(std::move(d)) / (0.6744897501960817 * std::sqrt(70.0));  // that of |normal|; 1 + 16 + 36 + 16 + 1 = 70
  // Most samples of a coarsely quantised log repeat: the noise is then uniform within a step.
  double step = 0;
  std::size_t unchanged = 0;
  for (std::size_t i = 0; i + 1 < x.size(); ++i) {
    const double change = std::abs(x[i + 1] - x[i]);
    if (change < 1e-12)
      ++unchanged;
    else
      step = step == 0 ? change : std::min(step, change);
  }
  return 2 * unchanged > x.size() ? std::max(white, step / std::sqrt(12.0)) : white;
}

double largest_deviation(const std::vector<double>& x, double from) {
  double out = 0;
  for (const double v : x) out = std::max(out, std::abs(v - from));
  return out;
}

}  // namespace ukemi

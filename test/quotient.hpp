// Difference quotients that say how well they are known.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

/// A difference quotient and how far its neighbours in Richardson's table are from it.
struct Quotient {
  double value = 0, error = std::numeric_limits<double>::infinity();
};
/// Richardson's table of quotients q(h), q(h/2), ... whose errors are a series in h^kPower (Ridders 1982); it ends
/// where the error is below `sure` of the value.
template <int kPower, class F>
Quotient extrapolated(double h, double sure, F&& q) {
  constexpr int kLevels = 5;
  Quotient best;
  std::array<double, kLevels> last{}, row{};
  for (int i = 0; i < kLevels; ++i, h /= 2) {
    row[0] = q(h);
    double factor = 1;
    for (int j = 1; j <= i; ++j) {
      factor *= 1 << kPower;
      row[j] = (row[j - 1] * factor - last[j - 1]) / (factor - 1);
      const double error = std::max(std::abs(row[j] - row[j - 1]), std::abs(row[j] - last[j - 1]));
      if (error < best.error) best = {row[j], error};
    }
    if (best.error < sure * std::abs(best.value)) break;
    last = row;
  }
  return best;
}
/// The central quotient of f(x) at 0 for moves of `unit`, known within `sure` of itself where it can be, and the one
/// from one side.
template <class F>
Quotient central(double unit, double sure, F&& f) {
  const auto quotient = [&](double h) { return (f(h) - f(-h)) / (2 * h); };
  const Quotient wide = extrapolated<2>(1e-3 * unit, sure, quotient);
  if (wide.error < sure * std::abs(wide.value)) return wide;
  const Quotient narrow = extrapolated<2>(1e-5 * unit, sure, quotient);  // where f bends sharply
  return narrow.error < wide.error ? narrow : wide;
}
template <class F>
Quotient one_sided(double side, double unit, F&& f) {
  const double f0 = f(0);
  return extrapolated<1>(2e-4 * unit, 0, [&](double h) { return side * (f(side * h) - f0) / h; });
}

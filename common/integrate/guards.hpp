// Guards, and the first downward zero crossing within a step: on cubics, and by a safeguarded secant search.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "common/scalar.hpp"

namespace ukemi::integrate {

/// Guards of a mode: positive while the mode holds. An inactive guard has value 1 and rate 0; `guards()` sets
/// every one anew.
template <int N, class T = double>
struct Guards {
  std::array<T, N> value;
  std::array<T, N> rate;
  Guards() { value.fill(T(1)), rate.fill(T(0)); }
  void set(int i, const T& v, const T& r) { value[i] = v, rate[i] = r; }
  /// Sets a guard that is active where `active` is set, and inactive elsewhere.
  template <class Mask>
  void set(int i, const T& v, const T& r, const Mask& active) {
    value[i] = select(active, v, T(1)), rate[i] = select(active, r, T(0));
  }
};

/// A guard at one point of a step: fraction s of the step, value g, derivative d = dg/ds.
struct Node {
  double s, g, d;
};

/// The Hermite cubic through two nodes, at s; and the s of its interior minimum, -1 where there is none.
inline double cubic(const Node& a, const Node& b, double s) {
  const double w = b.s - a.s, x = (s - a.s) / w, y = 1 - x;
  return y * y * ((1 + 2 * x) * a.g + x * w * a.d) + x * x * ((3 - 2 * x) * b.g - y * w * b.d);
}
inline double cubic_minimum(const Node& a, const Node& b) {
  const double w = b.s - a.s, c1 = w * a.d, c2 = 3 * (b.g - a.g) - w * (2 * a.d + b.d),
               c3 = 2 * (a.g - b.g) + w * (a.d + b.d);
  const double disc = c2 * c2 - 3 * c1 * c3;  // root of c1 + 2 c2 x + 3 c3 x^2 with positive curvature
  if (disc <= 0) return -1;
  const double root = std::sqrt(disc), x = c2 > 0 ? -c1 / (c2 + root) : (c3 != 0 ? (root - c2) / (3 * c3) : -1);
  return x > 0 && x < 1 ? a.s + x * w : -1;
}
/// Lower bound of that cubic by its Bernstein coefficients; where it starts on zero, of its part after the start.
inline double bernstein_minimum(const Node& a, const Node& b) {
  const double w = (b.s - a.s) / 3, inner = std::min(b.g, std::min(a.g + w * a.d, b.g - w * b.d));
  return a.g > 0 ? std::min(a.g, inner) : inner;
}
/// Bisection with secant steps (Illinois) of a function that is positive at a and negative at b.
template <class F>
double root(double a, double fa, double b, double fb, F&& f, double resolution = 1e-14) {
  double last = -1;
  for (int i = 0, side = 0; i < 80 && b - a > resolution; ++i) {
    double m = (a * fb - b * fa) / (fb - fa);
    if (!(m > a && m < b)) m = 0.5 * (a + b);
    if (std::abs(m - last) < resolution) return m;
    const double fm = f(last = m);
    if (fm == 0) return m;
    if (fm < 0) {
      b = m, fb = fm;
      if (side == -1) fa *= 0.5;
      side = -1;
    } else {
      a = m, fa = fm;
      if (side == 1) fb *= 0.5;
      side = 1;
    }
  }
  return b;
}

/// A guard at the start of a step: a rising one within rounding of zero counts as zero. `d` is its rate times h.
inline Node start_node(double g, double d) {
  constexpr double kRounding = 1e-9;  // in fractions of the step
  return {0, g <= kRounding * d ? 0 : std::max(g, 0.0), d};
}

/// The s where a guard, `value(s)`, first falls to zero between two nodes on its cubic; kNoZero where it does not.
inline constexpr double kNoZero = 2;
template <class F>
double zero_between(const Node& a, const Node& b, F&& value, double resolution = 1e-14) {
  if (b.g >= 0 && bernstein_minimum(a, b) > 0) return kNoZero;
  double lower = a.s, at_lower = a.g, upper = b.s, at_upper = b.g;
  if (b.g >= 0) {  // both ends are positive: is the minimum between them negative?
    upper = cubic_minimum(a, b);
    if (upper < 0 || (at_upper = value(upper)) >= 0) return kNoZero;
  }
  if (a.g <= 0) {  // it starts on the zero that was just left: begin where the guard has risen
    const double w = upper - a.s;
    for (double x = 0.5; x > 1e-6; x *= 0.5)
      if ((at_lower = value(a.s + x * w)) > 0) {
        lower = a.s + x * w;
        break;
      }
    if (at_lower <= 0) return a.s;
  }
  return root(lower, at_lower, upper, at_upper, value, resolution);
}

}  // namespace ukemi::integrate

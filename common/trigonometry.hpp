// Sine and cosine of one angle together, for every scalar.
//
// The angle is reduced to |r| <= pi/4 by a multiple of pi/2 held in three parts,
// then both functions are polynomials in r^2. Method of W. J. Cody, W. Waite, Software Manual for the Elementary
// Functions (1980); coefficients of S. L. Moshier's Cephes library, double precision. Branch-free but for angles beyond
// kReducible, which go to the standard library. Test: test/unit/trigonometry.cpp (error below 1.2e-16 + 1 ulp).
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "common/scalar.hpp"

namespace ukemi {

/// sin x and cos x.
template <class T>
struct SinCos {
  T sin, cos;
};

/// Angles up to which the reduction is exact [rad].
inline constexpr double kReducible = 1 << 19;

/// Two doubles in one register of any x86-64 or ARM64 machine.
typedef double Double2 __attribute__((vector_size(16)));  // NOLINT(modernize-use-using): GCC's vector types

[[gnu::noinline, gnu::cold]] inline SinCos<double> sin_cos_library(double x) { return {std::sin(x), std::cos(x)}; }

namespace detail {
/// Each constant in both lanes, so that it is read as an operand and not broadcast at every use.
struct SinCosTable {
  Double2 two_over_pi{0.63661977236758134308, 0.63661977236758134308}, round{0x1.8p52, 0x1.8p52}, one{1, 1},
      half{0.5, 0.5};
  Double2 quarter_turn[3] = {{1.57079632673412561417e+00, 1.57079632673412561417e+00},
                             {6.07710050630396597660e-11, 6.07710050630396597660e-11},
                             {2.02226624879595063154e-21, 2.02226624879595063154e-21}};
  Double2 sin[6] = {{-1.66666666666666307295e-1, -1.66666666666666307295e-1},
                    {8.33333333332211858878e-3, 8.33333333332211858878e-3},
                    {-1.98412698295895385996e-4, -1.98412698295895385996e-4},
                    {2.75573136213857245213e-6, 2.75573136213857245213e-6},
                    {-2.50507477628578072866e-8, -2.50507477628578072866e-8},
                    {1.58962301576546568060e-10, 1.58962301576546568060e-10}};
  Double2 cos[6] = {{4.16666666666665929218e-2, 4.16666666666665929218e-2},
                    {-1.38888888888730564116e-3, -1.38888888888730564116e-3},
                    {2.48015872888517045348e-5, 2.48015872888517045348e-5},
                    {-2.75573141792967388112e-7, -2.75573141792967388112e-7},
                    {2.08757008419747316778e-9, 2.08757008419747316778e-9},
                    {-1.13585365213876817300e-11, -1.13585365213876817300e-11}};
};
inline const SinCosTable kSinCosTable;
typedef std::int64_t Bits2 __attribute__((vector_size(16)));  // NOLINT(modernize-use-using)

/// Sine and cosine of every lane, |x| < kReducible. D: a vector of doubles, I: the vector of integers of its size.
template <class D, class I>
UKEMI_INLINE void sin_cos_reduced(const D& x, D& sine, D& cosine, const SinCosTable* k = &kSinCosTable) {
  const auto c = [](const Double2& pair) UKEMI_INLINE_LAMBDA {
    if constexpr (sizeof(D) == sizeof(Double2))
      return pair;
    else
      return D{} + pair[0];
  };
  const D shifted = x * c(k->two_over_pi) + c(k->round), n = shifted - c(k->round);
  const D r = ((x - n * c(k->quarter_turn[0])) - n * c(k->quarter_turn[1])) - n * c(k->quarter_turn[2]), z = r * r,
          z2 = z * z;
  // Both polynomials by pairs (Estrin): what costs is the chain of dependent operations, not their number.
  const Double2 *p = k->sin, *q = k->cos;
  const D s = r + r * z * ((c(p[0]) + z * c(p[1])) + z2 * ((c(p[2]) + z * c(p[3])) + z2 * (c(p[4]) + z * c(p[5]))));
  const D t = (c(k->one) - c(k->half) * z) +
              z2 * ((c(q[0]) + z * c(q[1])) + z2 * ((c(q[2]) + z * c(q[3])) + z2 * (c(q[4]) + z * c(q[5]))));
  const I quadrant = (I)shifted, odd = -(quadrant & 1), bs = (I)s, bc = (I)t;
  sine = (D)(((bc & odd) | (bs & ~odd)) ^ ((quadrant & 2) << 62));
  cosine = (D)(((bs & odd) | (bc & ~odd)) ^ (((quadrant + 1) & 2) << 62));
}
}  // namespace detail

/// Sine and cosine of two angles, in the two lanes of one register.
UKEMI_INLINE std::array<SinCos<double>, 2> sin_cos(double x0, double x1) {
  const detail::SinCosTable* k = &detail::kSinCosTable;
  __asm__("" : "+r"(k));  // else the compiler rebuilds each constant from one lane
  if (!(std::abs(x0) < kReducible && std::abs(x1) < kReducible)) return {sin_cos_library(x0), sin_cos_library(x1)};
  Double2 sine, cosine;
  detail::sin_cos_reduced<Double2, detail::Bits2>(Double2{x0, x1}, sine, cosine, k);
  return {{{sine[0], cosine[0]}, {sine[1], cosine[1]}}};
}

template <DualNumber T>
std::array<SinCos<T>, 2> sin_cos(const T& x0, const T& x1) {
  const auto [f0, f1] = sin_cos(x0.a, x1.a);
  return {
      {{T(f0.sin, f0.cos * x0.v), T(f0.cos, -f0.sin * x0.v)}, {T(f1.sin, f1.cos * x1.v), T(f1.cos, -f1.sin * x1.v)}}};
}

}  // namespace ukemi

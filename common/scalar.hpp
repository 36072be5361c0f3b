// What `double`, `Pack` and the dual numbers `ceres::Jet` share, so that an equation is written once for all of them.
// Code that differentiates includes common/jet.hpp.
//
// Kernels never branch on a Scalar: they use select(mask, a, b), and both a and b must be finite.
// Mode decisions are booleans that the drivers fix between events; any(mask) lets a kernel skip work that no lane
// needs.
#pragma once

#include <cmath>
#include <concepts>
#include <type_traits>

/// For the innermost functions of a kernel: not inlined, their arguments would go through memory.
#define UKEMI_INLINE [[gnu::always_inline]] inline
#define UKEMI_INLINE_LAMBDA __attribute__((always_inline))
/// For a stage of a kernel: all that it calls is inlined. Not in a build for debugging or with a sanitizer, where that
/// takes the compiler minutes.
#if defined(__OPTIMIZE__) && !defined(__SANITIZE_ADDRESS__)
#define UKEMI_FLATTEN [[gnu::flatten]]
#else
#define UKEMI_FLATTEN
#endif

namespace ukemi {

/// A real number with the field operations, a square root and the two trigonometric functions that the dynamics need.
template <class T>
concept Scalar = requires(T a, T b) {
  T(0.5);
  { -a } -> std::convertible_to<T>;
  { a + b } -> std::convertible_to<T>;
  { a - b } -> std::convertible_to<T>;
  { a* b } -> std::convertible_to<T>;
  { a / b } -> std::convertible_to<T>;
};

/// Number of derivatives that a scalar carries: a dual number has its value as `a`, its derivatives as `v`.
template <class T>
inline constexpr int kDerivatives = 0;
template <class T>
concept DualNumber = (kDerivatives<T> > 0);

/// mask ? a : b.
inline double select(bool mask, double a, double b) { return mask ? a : b; }
template <DualNumber T>
T select(bool mask, const T& a, const T& b) {
  return mask ? a : b;
}

/// mask ? x : 0.
template <class T>
T masked(bool mask, const T& x) {
  return mask ? x : T(0);
}

/// True where any lane of the mask is set; a plain bool has one lane.
inline bool any(bool mask) { return mask; }

/// True for the packs of pack.hpp, whose lanes are independent; MaskOf: the mask type of a scalar.
template <class T>
inline constexpr bool kIsPack = false;
template <class T>
struct MaskOf {
  using type = bool;
};
/// Type of times and step lengths: one double for a scalar with its derivatives, one per lane of a pack.
template <class T>
using TimeOf = std::conditional_t<kIsPack<T>, T, double>;

/// The value without its derivatives.
inline double value_of(double x) { return x; }
template <DualNumber T>
double value_of(const T& x) {
  return x.a;
}
/// x as a To: itself, or its value without its derivatives.
template <class To, class T>
UKEMI_INLINE To narrowed(const T& x) {
  if constexpr (std::is_same_v<To, T>)
    return x;
  else
    return value_of(x);
}

/// One of the derivatives.
template <DualNumber T>
double derivative_of(const T& x, int slot) {
  return x.v[slot];
}

/// Whether a term is active: its constant is not 0, or derivatives by it are needed.
template <class T>
auto present(const T& x) {
  return x != T(0);
}
template <DualNumber T>
bool present(const T& x) {
  return x.a != 0 || !x.v.isZero(0);
}

/// y += w x, without temporaries: the inner operation of every integrator.
UKEMI_INLINE void add_scaled(double& y, double w, double x) { y += w * x; }
template <DualNumber T>
UKEMI_INLINE void add_scaled(T& y, double w, const T& x) {
  y.a += w * x.a;
  for (int i = 0; i < kDerivatives<T>; ++i) y.v[i] += w * x.v[i];
}

/// y += a b, without temporaries.
UKEMI_INLINE void add_product(double& y, double a, double b) { y += a * b; }
template <DualNumber T>
UKEMI_INLINE void add_product(T& y, const T& a, const T& b) {
  y.a += a.a * b.a;
  for (int i = 0; i < kDerivatives<T>; ++i) y.v[i] += a.a * b.v[i] + b.a * a.v[i];
}

}  // namespace ukemi

// A pack of doubles: the lanes of one SIMD register, each a computation of its own. Included only by batch code.
//
// Built on the compiler's vector extension and not on std::experimental::simd: a vector of W doubles means the same
// whatever the instruction set of the file, so one file holds the kernels of every instruction set and none of its
// inline functions can end up, through the linker, in a program for a lesser machine. What is not inlined into a
// kernel's entry is compiled for the baseline: slower, never wrong.
// Lanes never mix: what a lane computes does not depend on its neighbours.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "common/scalar.hpp"
#include "common/trigonometry.hpp"

namespace ukemi {

template <int W>
struct Vectors {
  typedef double Doubles __attribute__((vector_size(8 * W)));
  typedef std::int64_t Integers __attribute__((vector_size(8 * W)));
};

/// One truth value a lane.
template <int W>
struct Mask {
  using Lanes = typename Vectors<W>::Integers;
  Lanes v;

  UKEMI_INLINE Mask(bool b = false) : v(Lanes{} - std::int64_t(b)) {}
  UKEMI_INLINE explicit Mask(const Lanes& lanes) : v(lanes) {}
  UKEMI_INLINE Mask(const Mask& o) : v(o.v) {}  // user-provided: passed in memory, alike for every instruction set
  UKEMI_INLINE Mask& operator=(const Mask& o) {
    v = o.v;
    return *this;
  }
  UKEMI_INLINE bool operator[](int i) const { return v[i] != 0; }
  UKEMI_INLINE void set(int i, bool b) { v[i] = -std::int64_t(b); }

  UKEMI_INLINE friend Mask operator&(const Mask& a, const Mask& b) { return Mask(Lanes(a.v & b.v)); }
  UKEMI_INLINE friend Mask operator|(const Mask& a, const Mask& b) { return Mask(Lanes(a.v | b.v)); }
  UKEMI_INLINE friend Mask operator!(const Mask& a) { return Mask(Lanes(~a.v)); }
  UKEMI_INLINE Mask& operator&=(const Mask& b) {
    v &= b.v;
    return *this;
  }
  UKEMI_INLINE Mask& operator|=(const Mask& b) {
    v |= b.v;
    return *this;
  }
};

template <int W>
UKEMI_INLINE bool any(const Mask<W>& m) {
  if constexpr (W > 2) {
    Mask<W / 2> low, high;
    __builtin_memcpy(&low.v, &m.v, sizeof low.v);
    __builtin_memcpy(&high.v, reinterpret_cast<const char*>(&m.v) + sizeof low.v, sizeof high.v);
    return any(low | high);
  } else {
    return (m.v[0] | m.v[1]) != 0;
  }
}

/// W doubles.
template <int W>
struct Pack {
  using Lanes = typename Vectors<W>::Doubles;
  Lanes v;

  Pack() = default;
  UKEMI_INLINE Pack(double x) : v(Lanes{} + x) {}
  UKEMI_INLINE explicit Pack(const Lanes& lanes) : v(lanes) {}
  UKEMI_INLINE Pack(const Pack& o) : v(o.v) {}  // user-provided: passed in memory, alike for every instruction set
  UKEMI_INLINE Pack& operator=(const Pack& o) {
    v = o.v;
    return *this;
  }
  UKEMI_INLINE double operator[](int i) const { return v[i]; }
  UKEMI_INLINE void set(int i, double x) { v[i] = x; }

  UKEMI_INLINE friend Pack operator+(const Pack& a, const Pack& b) { return Pack(Lanes(a.v + b.v)); }
  UKEMI_INLINE friend Pack operator-(const Pack& a, const Pack& b) { return Pack(Lanes(a.v - b.v)); }
  UKEMI_INLINE friend Pack operator*(const Pack& a, const Pack& b) { return Pack(Lanes(a.v * b.v)); }
  UKEMI_INLINE friend Pack operator/(const Pack& a, const Pack& b) { return Pack(Lanes(a.v / b.v)); }
  UKEMI_INLINE friend Pack operator-(const Pack& a) { return Pack(Lanes(-a.v)); }
  UKEMI_INLINE Pack& operator+=(const Pack& b) {
    v += b.v;
    return *this;
  }
  UKEMI_INLINE Pack& operator-=(const Pack& b) {
    v -= b.v;
    return *this;
  }
  UKEMI_INLINE Pack& operator*=(const Pack& b) {
    v *= b.v;
    return *this;
  }
  UKEMI_INLINE friend Mask<W> operator<(const Pack& a, const Pack& b) { return to_mask(a.v < b.v); }
  UKEMI_INLINE friend Mask<W> operator<=(const Pack& a, const Pack& b) { return to_mask(a.v <= b.v); }
  UKEMI_INLINE friend Mask<W> operator>(const Pack& a, const Pack& b) { return to_mask(a.v > b.v); }
  UKEMI_INLINE friend Mask<W> operator>=(const Pack& a, const Pack& b) { return to_mask(a.v >= b.v); }
  UKEMI_INLINE friend Mask<W> operator==(const Pack& a, const Pack& b) { return to_mask(a.v == b.v); }
  UKEMI_INLINE friend Mask<W> operator!=(const Pack& a, const Pack& b) { return to_mask(a.v != b.v); }

 private:
  template <class Compared>
  UKEMI_INLINE static Mask<W> to_mask(const Compared& c) {
    using Truth = typename Mask<W>::Lanes;
    Mask<W> m;
    // GCC 12 splits a comparison of eight lanes that is used as integers into scalars (13 times the instructions), but
    // not a select.
    if constexpr (W > 4)
      m.v = (Truth)(c ? (Lanes)(Truth{} - 1) : Lanes{});
    else
      m.v = (Truth)c;
    return m;
  }
};

template <int W>
UKEMI_INLINE Pack<W> select(const Mask<W>& m, const Pack<W>& a, const Pack<W>& b) {
  return Pack<W>(typename Pack<W>::Lanes(m.v ? a.v : b.v));
}
template <int W>
UKEMI_INLINE Pack<W> select(bool m, const Pack<W>& a, const Pack<W>& b) {
  return m ? a : b;
}
template <int W>
UKEMI_INLINE Mask<W> select(const Mask<W>& m, const Mask<W>& a, const Mask<W>& b) {
  return (m & a) | (!m & b);
}
/// m ? x : 0, by bits: nested selects of 512 bits are an internal error of GCC 12.
template <int W>
UKEMI_INLINE Pack<W> masked(const Mask<W>& m, const Pack<W>& x) {
  using I = typename Mask<W>::Lanes;
  return Pack<W>((typename Pack<W>::Lanes)((I)x.v & m.v));
}
/// Sets the lanes of `mask` that are set in `where` to `value`.
template <int W>
UKEMI_INLINE void assign(Mask<W>& mask, const Mask<W>& where, const Mask<W>& value) {
  mask = select(where, value, mask);
}
template <int W>
UKEMI_INLINE void assign(Pack<W>& x, const Mask<W>& where, const Pack<W>& value) {
  x = select(where, value, x);
}

template <int W>
UKEMI_INLINE Pack<W> abs(const Pack<W>& x) {
  return Pack<W>(typename Pack<W>::Lanes(x.v < 0 ? -x.v : x.v));
}
template <int W>
UKEMI_INLINE Pack<W> min(const Pack<W>& a, const Pack<W>& b) {
  return Pack<W>(typename Pack<W>::Lanes(a.v < b.v ? a.v : b.v));
}
template <int W>
UKEMI_INLINE Pack<W> max(const Pack<W>& a, const Pack<W>& b) {
  return Pack<W>(typename Pack<W>::Lanes(a.v > b.v ? a.v : b.v));
}
template <int W>
UKEMI_INLINE Pack<W> sqrt(const Pack<W>& x) {
  Pack<W> out;
  for (int i = 0; i < W; ++i) out.v[i] = __builtin_sqrt(x.v[i]);
  return out;
}
template <int W>
Pack<W> exp(const Pack<W>& x) {
  Pack<W> out;
  for (int i = 0; i < W; ++i) out.v[i] = __builtin_exp(x.v[i]);
  return out;
}
/// True where x is neither infinite nor NaN.
template <int W>
UKEMI_INLINE Mask<W> finite(const Pack<W>& x) {
  return x - x == Pack<W>(0.0);
}
template <int W>
UKEMI_INLINE const Pack<W>& value_of(const Pack<W>& x) {
  return x;
}
template <int W>
UKEMI_INLINE void add_scaled(Pack<W>& y, const Pack<W>& w, const Pack<W>& x) {
  y += w * x;
}

/// x^(-1/10) for x > 0, relative error 2e-3: the step-size controller's root of a squared error.
template <int W>
UKEMI_INLINE Pack<W> inverse_tenth_root(const Pack<W>& x) {
  using I = typename Mask<W>::Lanes;
  using D = typename Pack<W>::Lanes;
  constexpr double kTwo52 = 0x1p52;
  const I bits = (I)x.v;
  const D exponent = (D)((I)((typename Mask<W>::Lanes)(bits >> 52) | (I)(D{} + kTwo52))) - (kTwo52 + 1023);
  const D m = (D)((bits & 0x000FFFFFFFFFFFFF) | 0x3FF0000000000000);  // 1..2
  const D log2 = exponent + (((-0.0821343 * m + 0.6491843) * m - 2.1344986) * m + 4.0700906) * m - 2.5026420;
  const D power = log2 * -0.1, shifted = power + 0x1.8p52, whole = shifted - 0x1.8p52, fraction = power - whole;
  const D two_to_fraction = 1 + fraction * (0.6931472 + fraction * (0.2402265 + fraction * 0.0558));
  const I scale = ((I)shifted << 52) + (I)(D{} + 1.0);
  return Pack<W>(D(two_to_fraction * (D)scale));
}

template <int W>
inline constexpr bool kIsPack<Pack<W>> = true;
template <int W>
struct MaskOf<Pack<W>> {
  using type = Mask<W>;
};

/// Sine and cosine of both angles in every lane.
template <int W>
UKEMI_INLINE std::array<SinCos<Pack<W>>, 2> sin_cos(const Pack<W>& x0, const Pack<W>& x1) {
  using D = typename Pack<W>::Lanes;
  using I = typename Mask<W>::Lanes;
  const auto sin_cos_of = [](const Pack<W>& x) UKEMI_INLINE_LAMBDA {
    SinCos<Pack<W>> out;
    detail::sin_cos_reduced<D, I>(x.v, out.sin.v, out.cos.v);
    const Mask<W> large = abs(x) >= Pack<W>(kReducible);
    if (any(large))
      for (int i = 0; i < W; ++i)
        if (large[i]) {
          const SinCos<double> exact = sin_cos_library(x[i]);
          out.sin.set(i, exact.sin), out.cos.set(i, exact.cos);
        }
    return out;
  };
  return {sin_cos_of(x0), sin_cos_of(x1)};
}

}  // namespace ukemi

namespace Eigen {
template <int W>
struct NumTraits<ukemi::Pack<W>> : NumTraits<double> {
  using Real = ukemi::Pack<W>;
  using NonInteger = ukemi::Pack<W>;
  using Nested = ukemi::Pack<W>;
  using Literal = double;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 0,
    ReadCost = 1,
    AddCost = 1,
    MulCost = 1
  };
};
}  // namespace Eigen

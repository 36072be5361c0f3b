// Reflection of the fields of aggregates, for equality, hash and pickles in Python. A field added to a struct of the
// libraries is found without a change here; the fields of a struct with a base are listed in parts.hpp.
#pragma once

#include <type_traits>
#include <utility>

namespace ukemi::python {

/// Converts to any field type; to count fields.
struct AnyField {
  template <class T>
  operator T() const;
};
template <std::size_t>
using AnyFieldAt = AnyField;

template <class T, std::size_t... I>
constexpr bool is_initializable(std::index_sequence<I...>) {
  return requires { T{AnyFieldAt<I>{}...}; };
}
/// Number of fields of an aggregate, at most 32; each base counts as one.
template <class T, std::size_t N = 32>
constexpr std::size_t field_count() {
  static_assert(std::is_aggregate_v<T>, "not a struct of fields: see serialize of archive.hpp");
  if constexpr (N == 0)
    return 0;
  else if constexpr (is_initializable<T>(std::make_index_sequence<N>()))
    return N;
  else
    return field_count<T, N - 1>();
}

/// Calls f(field) for every field of a struct without a base, in order.
template <class T, class F>
void for_each_field(T& x, F&& f) {
  constexpr std::size_t n = field_count<std::remove_const_t<T>>();
  [[maybe_unused]] const auto visit = [&f](auto&... field) { (f(field), ...); };
#define UKEMI_FIELDS(N, ...)   \
  if constexpr (n == N) {      \
    auto& [__VA_ARGS__] = x;   \
    return visit(__VA_ARGS__); \
  }
  UKEMI_FIELDS(1, a)
  UKEMI_FIELDS(2, a, b)
  UKEMI_FIELDS(3, a, b, c)
  UKEMI_FIELDS(4, a, b, c, d)
  UKEMI_FIELDS(5, a, b, c, d, e)
  UKEMI_FIELDS(6, a, b, c, d, e, g)
  UKEMI_FIELDS(7, a, b, c, d, e, g, h)
  UKEMI_FIELDS(8, a, b, c, d, e, g, h, i)
  UKEMI_FIELDS(9, a, b, c, d, e, g, h, i, j)
  UKEMI_FIELDS(10, a, b, c, d, e, g, h, i, j, k)
  UKEMI_FIELDS(11, a, b, c, d, e, g, h, i, j, k, l)
  UKEMI_FIELDS(12, a, b, c, d, e, g, h, i, j, k, l, m)
  UKEMI_FIELDS(13, a, b, c, d, e, g, h, i, j, k, l, m, o)
  UKEMI_FIELDS(14, a, b, c, d, e, g, h, i, j, k, l, m, o, p)
  UKEMI_FIELDS(15, a, b, c, d, e, g, h, i, j, k, l, m, o, p, q)
  UKEMI_FIELDS(16, a, b, c, d, e, g, h, i, j, k, l, m, o, p, q, r)
  UKEMI_FIELDS(17, a, b, c, d, e, g, h, i, j, k, l, m, o, p, q, r, s)
  UKEMI_FIELDS(18, a, b, c, d, e, g, h, i, j, k, l, m, o, p, q, r, s, t)
  UKEMI_FIELDS(19, a, b, c, d, e, g, h, i, j, k, l, m, o, p, q, r, s, t, u)
  UKEMI_FIELDS(20, a, b, c, d, e, g, h, i, j, k, l, m, o, p, q, r, s, t, u, v)
  UKEMI_FIELDS(21, a, b, c, d, e, g, h, i, j, k, l, m, o, p, q, r, s, t, u, v, w)
  UKEMI_FIELDS(22, a, b, c, d, e, g, h, i, j, k, l, m, o, p, q, r, s, t, u, v, w, y)
  UKEMI_FIELDS(23, a, b, c, d, e, g, h, i, j, k, l, m, o, p, q, r, s, t, u, v, w, y, z)
  UKEMI_FIELDS(24, a, b, c, d, e, g, h, i, j, k, l, m, o, p, q, r, s, t, u, v, w, y, z, a1)
  UKEMI_FIELDS(25, a, b, c, d, e, g, h, i, j, k, l, m, o, p, q, r, s, t, u, v, w, y, z, a1, a2)
#undef UKEMI_FIELDS
  static_assert(n <= 25, "more fields than are listed here");
}

}  // namespace ukemi::python

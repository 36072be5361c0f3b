#include "landing/scatter/sobol.hpp"

#include <boost/random/sobol.hpp>

#include "common/random.hpp"

namespace ukemi::landing {

namespace {

std::uint32_t bit_reversed(std::uint32_t x) {
  x = (x & 0x55555555u) << 1 | (x >> 1 & 0x55555555u);
  x = (x & 0x33333333u) << 2 | (x >> 2 & 0x33333333u);
  x = (x & 0x0f0f0f0fu) << 4 | (x >> 4 & 0x0f0f0f0fu);
  return __builtin_bswap32(x);
}

/// Laine and Karras' permutation, with Vegdahl's constants: each bit depends only on those below it.
std::uint32_t permuted(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

/// Owen's scrambling: each bit depends only on those above it.
std::uint32_t scrambled(std::uint32_t x, std::uint32_t seed) { return bit_reversed(permuted(bit_reversed(x), seed)); }

}  // namespace

ScrambledSobol::ScrambledSobol(int dimension, std::uint64_t seed) {
  for (int k = 0; k < dimension; ++k) seeds_.push_back(std::uint32_t(Random(seed, std::uint64_t(k)).bits() >> 32));
}

std::vector<double> ScrambledSobol::points(long count, long first) const {
  const std::size_t d = seeds_.size();
  std::vector<double> out;
  out.reserve(std::size_t(count) * d);
  boost::random::sobol_engine<std::uint32_t, 32> engine(d);
  if (first > 0) engine.seed(std::uint32_t(first - 1));  // Boost omits the origin
  for (long n = first; n < first + count; ++n)
    for (std::size_t k = 0; k < d; ++k) {
      const std::uint32_t x = n == 0 ? 0 : std::uint32_t(engine());
      out.push_back((double(scrambled(x, seeds_[k])) + 0.5) * 0x1.0p-32);
    }
  return out;
}

}  // namespace ukemi::landing

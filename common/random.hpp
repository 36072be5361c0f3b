// Random draws that belong to the index of their item, not to the order of work.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace ukemi {

/// SplitMix64 (Steele, Lea, Flood 2014): a small generator whose streams are keyed by (seed, index).
class Random {
 public:
  explicit Random(std::uint64_t seed, std::uint64_t index = 0)
      : state_(mix(seed + 0x9E3779B97F4A7C15ull * (index + 1))) {}

  std::uint64_t bits() {
    state_ += 0x9E3779B97F4A7C15ull;
    return mix(state_);
  }
  /// Uniform in [0, 1).
  double uniform() { return double(bits() >> 11) * 0x1.0p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Log-uniform in [1 / spread, spread].
  double factor(double spread) { return std::exp(std::log(spread) * uniform(-1, 1)); }
  /// Standard normal (Box-Muller).
  double normal() {
    const double u = 1 - uniform(), v = uniform();
    return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);
  }

 private:
  static std::uint64_t mix(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    return z ^ (z >> 31);
  }
  std::uint64_t state_;
};

}  // namespace ukemi

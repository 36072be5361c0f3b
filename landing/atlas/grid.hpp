// The drops of an atlas: a grid, partitioned into blocks that depend on the grid alone.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "landing/model/scene.hpp"

namespace ukemi::landing {

/// `count` values from `lower` to `upper`, both included; one of a fixed number. The layout of a file.
struct AtlasAxis {
  double lower, upper;
  std::uint64_t count;  ///< 1 of a fixed number, else >= 2

  double at(std::size_t i) const {
    return i + 1 < count ? lower + (upper - lower) * double(i) / double(count - 1) : upper;
  }
  bool stands() const { return count == 1; }
  bool contains(double x) const { return stands() || (x >= lower && x <= upper); }
};

/// Drops from rest by height [m], forward speed [m/s] and pitch [rad], the pitch fastest.
struct AtlasGrid {
  static constexpr std::size_t kAxes = 3;
  static constexpr std::size_t kMostDrops = 1'000'000;
  using Place = std::array<std::size_t, kAxes>;
  static constexpr std::array<const char*, kAxes> kNames = {"height", "speed", "pitch"};
  std::array<AtlasAxis, kAxes> axes{};

  /// Throws InputError for an axis of several values that does not increase, a height below 0, a pitch beyond a turn,
  /// or more than kMostDrops drops.
  void validate() const;
  /// Throws InputError unless it is valid and has as many drops as `cells`.
  void check_cells(std::size_t cells) const;
  std::size_t size() const { return axes[0].count * axes[1].count * axes[2].count; }
  std::size_t index(const Place& at) const { return (at[0] * axes[1].count + at[1]) * axes[2].count + at[2]; }
  Place place(std::size_t index) const;
  Drop drop(std::size_t index) const;

  /// Boxes of up to three drops a side: their drops are warm starts for each other, and belong to one shard.
  std::size_t blocks() const;
  /// The drops of block b, from its middle outwards: the order in which they are planned.
  std::vector<std::size_t> block(std::size_t b) const;
};

/// Part k of n, 1 to n, of the blocks: k, k + n, k + 2n, ...
struct AtlasShard {
  std::size_t k = 1, n = 1;
  /// Throws InputError unless 1 <= k <= n <= blocks.
  void validate(const AtlasGrid& grid) const;
  std::vector<std::size_t> blocks(const AtlasGrid& grid) const;
  /// Its drops, in the grid's order.
  std::vector<std::size_t> drops(const AtlasGrid& grid) const;
};

}  // namespace ukemi::landing

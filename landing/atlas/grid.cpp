#include "landing/atlas/grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/degrees.hpp"
#include "common/error.hpp"

namespace ukemi::landing {

namespace {

constexpr std::size_t kBlockSide = 3;  // drops

std::size_t blocks_along(const AtlasAxis& axis) { return (axis.count + kBlockSide - 1) / kBlockSide; }

}  // namespace

void AtlasGrid::validate() const {
  double drops = 1;
  for (std::size_t k = 0; k < kAxes; ++k) {
    const AtlasAxis& a = axes[k];
    if (!(std::isfinite(a.lower) && std::isfinite(a.upper) &&
          (a.count == 1 ? a.lower == a.upper : a.lower < a.upper && a.count >= 2)))
      throw InputError(fmt::format("atlas: {}: {} to {} in {}: finite numbers that rise, and at least 2, are needed",
                                   kNames[k], a.lower, a.upper, a.count));
    drops *= double(a.count);
  }
  if (axes[0].lower < 0) throw InputError(fmt::format("atlas: height: {}: at least 0 m is needed", axes[0].lower));
  constexpr double kTurn = 2 * std::numbers::pi;
  if (!(std::max(std::abs(axes[2].lower), std::abs(axes[2].upper)) <= kTurn))
    throw InputError(fmt::format("atlas: pitch: {:.4g} to {:.4g} deg: within 360 deg, 2 pi, is needed",
                                 axes[2].lower * kDegrees, axes[2].upper * kDegrees));
  if (drops > double(kMostDrops))
    throw InputError(fmt::format("atlas: {:.0f} drops: at most {} are planned", drops, kMostDrops));
}

void AtlasGrid::check_cells(std::size_t cells) const {
  validate();
  if (cells != size())
    throw InputError(fmt::format("atlas: {} cells: {} are needed, one for each drop", cells, size()));
}

AtlasGrid::Place AtlasGrid::place(std::size_t index) const {
  const std::size_t row = index / axes[2].count;
  return {row / axes[1].count, row % axes[1].count, index % axes[2].count};
}

Drop AtlasGrid::drop(std::size_t index) const {
  const Place p = place(index);
  return {.height = axes[0].at(p[0]), .forward_speed = axes[1].at(p[1]), .pitch = axes[2].at(p[2])};
}

std::size_t AtlasGrid::blocks() const { return blocks_along(axes[0]) * blocks_along(axes[1]) * blocks_along(axes[2]); }

std::vector<std::size_t> AtlasGrid::block(std::size_t b) const {
  const std::size_t row = b / blocks_along(axes[2]);
  const Place part{row / blocks_along(axes[1]), row % blocks_along(axes[1]), b % blocks_along(axes[2])};
  Place from{}, to{};
  for (std::size_t k = 0; k < kAxes; ++k) {
    from[k] = part[k] * axes[k].count / blocks_along(axes[k]);
    to[k] = (part[k] + 1) * axes[k].count / blocks_along(axes[k]);
  }
  const auto centre_distance = [&](const Place& p) {  // in half steps
    std::size_t sum = 0;
    for (std::size_t k = 0; k < kAxes; ++k) {
      const std::size_t twice = 2 * p[k], middle = from[k] + to[k] - 1;
      sum += twice > middle ? twice - middle : middle - twice;
    }
    return sum;
  };
  std::vector<std::size_t> out;
  Place p{};
  for (p[0] = from[0]; p[0] < to[0]; ++p[0])
    for (p[1] = from[1]; p[1] < to[1]; ++p[1])
      for (p[2] = from[2]; p[2] < to[2]; ++p[2]) out.push_back(index(p));
  std::stable_sort(out.begin(), out.end(),
                   [&](std::size_t i, std::size_t j) { return centre_distance(place(i)) < centre_distance(place(j)); });
  return out;
}

void AtlasShard::validate(const AtlasGrid& grid) const {
  if (k < 1 || k > n || n > grid.blocks())
    throw InputError(fmt::format("shard: {}/{}: K/N with 1 <= K <= N <= {}, the blocks of this grid, is needed", k, n,
                                 grid.blocks()));
}

std::vector<std::size_t> AtlasShard::blocks(const AtlasGrid& grid) const {
  std::vector<std::size_t> out;
  for (std::size_t b = k - 1; b < grid.blocks(); b += n) out.push_back(b);
  return out;
}

std::vector<std::size_t> AtlasShard::drops(const AtlasGrid& grid) const {
  std::vector<std::size_t> out;
  for (const std::size_t b : blocks(grid))
    for (const std::size_t i : grid.block(b)) out.push_back(i);
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace ukemi::landing

// The minimum of a function of one variable with narrow valleys: on a grid, then on ever finer ones around the best.
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "common/parallel.hpp"

namespace ukemi::landing {

/// A value and its angle.
struct PostureMinimum {
  double phi = 0, value = std::numeric_limits<double>::infinity();
};
struct Grids {
  int points, rounds;
  double reach;  ///< of the next grid to either side of the best, in steps
};
/// Over [low, high]; f(phi), by several threads at once.
template <class F>
PostureMinimum refined_minimum(double low, double high, const Grids& grids, int threads, F&& f) {
  PostureMinimum best;
  for (int round = 0; round < grids.rounds; ++round) {
    std::vector<PostureMinimum> row(std::size_t(grids.points));
    const double step = (high - low) / (grids.points - 1);
    parallel_for(grids.points, threads, [&](int i) {
      const double phi = low + step * i;
      row[std::size_t(i)] = {phi, f(phi)};
    });
    for (const PostureMinimum& m : row)
      if (m.value < best.value) best = m;
    low = std::max(low, best.phi - grids.reach * step), high = std::min(high, best.phi + grids.reach * step);
  }
  return best;
}

}  // namespace ukemi::landing

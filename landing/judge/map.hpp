// The whole box of motions on a grid, and the basins that it shows.
#pragma once

#include "landing/lanes/batch.hpp"
#include "landing/judge/evidence.hpp"

namespace ukemi::landing {

struct MapOptions {
  std::array<int, 3> cells{64, 64, 32};  ///< points of phi_I, phi_F, duration, ends included; each >= 2
  double accuracy = 1e-5;                ///< of the grid's landings
  double tight = 1e-9;                   ///< of the basins
  int polished = 24;                     ///< the best local minima of the grid are searched from close by
  std::uint64_t seed = 1;
  int threads = 0;
  Monitor monitor;        ///< told of the grid's rows, and of the basins
  void validate() const;  ///< throws InputError
};

struct PeakMap {
  struct Cell {
    double peak;            ///< [m/s^2]; NaN where the landing could not be followed, or was stopped before
    ContactOrder contacts;  ///< in which the points touch
    int peak_contact;       ///< which of them made the peak; -1: none
    End end;                ///< kStopped: not played, as the monitor stopped the map
  };
  std::array<int, 3> cells;
  std::vector<Cell> grid;  ///< phi_I slowest, duration fastest
  std::array<std::array<double, 2>, 3> range;

  std::size_t index(int i, int j, int k) const {
    return (std::size_t(i) * std::size_t(cells[1]) + std::size_t(j)) * std::size_t(cells[2]) + std::size_t(k);
  }
  double coordinate(int axis, int i) const {
    const auto& r = range[std::size_t(axis)];
    return r[0] + (r[1] - r[0]) * i / (cells[std::size_t(axis)] - 1);
  }
  Motion motion(int i, int j, int k) const { return {coordinate(0, i), coordinate(1, j), coordinate(2, k)}; }
};

/// Every point of the grid, on all lanes and threads, until the monitor stops it.
[[nodiscard]] PeakMap map_peaks(const Scene& scene, const SeaParameters<double>& sea, const MapOptions& options = {});

/// A basin: the best motion found near a local minimum of the grid, at MapOptions::tight.
struct Basin {
  Motion motion;
  double peak;
};
/// The distinct basins of the grid's best local minima, the best first; where the monitor stops it, those whose search
/// has ended.
[[nodiscard]] std::vector<Basin> basins(const Scene& scene, const SeaParameters<double>& sea, const PeakMap& map,
                                        const MapOptions& options = {});

}  // namespace ukemi::landing

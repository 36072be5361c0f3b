// Peaks on a grid over the box of a motion space, or a slice of it, and the basins found from it.
#pragma once

#include <cstdint>
#include <vector>

#include "common/monitor.hpp"
#include "landing/model/variables.hpp"
#include "landing/run/landing.hpp"

namespace ukemi::landing {

struct MapOptions {
  /// Points along each variable, ends included; 1, or none given: the variable is fixed at its value in `slice`.
  std::vector<int> cells{64, 64, 32};
  MotionValues slice;      ///< values of the fixed variables; empty: the middle of their ranges
  double accuracy = 1e-5;  ///< of the grid's landings
  double tight = 1e-9;     ///< of the basins
  int polished = 24;       ///< number of the grid's best local minima from which a local search starts
  std::uint64_t seed = 1;
  int threads = 0;
  Monitor monitor;        ///< progress in the grid's rows, and in the basins
  void validate() const;  ///< throws InputError
};

struct PeakMap {
  struct Cell {
    double peak;            ///< [m/s^2], with loads their `worth`; NaN where there is none, see `end`
    ContactOrder contacts;  ///< of the contact points
    int peak_contact;       ///< index of the one of the peak; -1: none
    bool joint_lost;        ///< see LandingPeak
    End end;                ///< kStopped: not played, as the monitor stopped the map
  };
  using Place = std::vector<int>;   ///< index of a point along each variable
  std::vector<Variable> variables;  ///< of the motion space
  Place cells;                      ///< points along each
  MotionValues slice;               ///< values of the variables with one point
  std::vector<Cell> grid;           ///< the first variable slowest, the last fastest
  std::size_t index(const Place& at) const;
  Place place(std::size_t index) const;
  /// The value of a variable at its i-th point.
  double coordinate(int variable, int i) const;
  MotionValues values(const Place& at) const;
  /// The points at most one step away along every variable, the point itself included.
  std::vector<std::size_t> neighbours(std::size_t index) const;
};

/// A number of a motion, from one value to another.
struct MotionRange {
  double Motion::*number;
  double low, high;
};
/// The peaks of a motion over the ranges of two of its numbers, `cells` values each (2 to 4096), the others fixed; row
/// by row, the first row at y.low [m/s^2]. NaN where a landing could not be followed.
[[nodiscard]] std::vector<double> peak_slice(const Scene& scene, const SeaParameters<double>& sea, const Motion& motion,
                                             const MotionRange& x, const MotionRange& y, int cells, int threads = 0);

/// Every point of the grid over the motions of Eq. 6, on all lanes and threads, until the monitor stops it.
[[nodiscard]] PeakMap map_peaks(const Scene& scene, const SeaParameters<double>& sea, const MapOptions& options = {});

}  // namespace ukemi::landing

// A grid of peaks and its basins, shared by the maps of the paper's robot and of robots of links.
#pragma once

#include <functional>
#include <span>

#include "landing/judge/map.hpp"
#include "landing/search/objective.hpp"

namespace ukemi::landing {

/// Plays the cells of the grid from index `first` on; called from several threads.
using PlayCells = std::function<void(const PeakMap& map, std::size_t first, std::span<PeakMap::Cell> cells)>;
/// Every point of a grid over variables, a row along the last one that varies at a time, until the monitor stops it.
/// Throws InputError for options that do not fit the variables.
[[nodiscard]] PeakMap map_peaks(const std::vector<Variable>& variables, const MapOptions& options,
                                const PlayCells& play);
/// The cell of a landing and its value.
[[nodiscard]] PeakMap::Cell cell_of(const RunEnd& landing, double value);

/// The grid's points that are as low as all their neighbours, the lowest first.
[[nodiscard]] std::vector<std::size_t> local_minima(const PeakMap& map);

/// The minimum of a local search from the cell of the n-th local minimum; kNoMotion where none could be followed.
using Descend = std::function<Candidate(const PeakMap::Place& cell, std::uint64_t n)>;
/// Distinct basins of the best local minima, the best first; where the monitor stops it, those of finished searches.
[[nodiscard]] std::vector<Candidate> distinct_basins(const PeakMap& map, const MapOptions& options,
                                                     const Descend& descend);

}  // namespace ukemi::landing

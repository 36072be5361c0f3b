// A survey of the box of motions: its map, the basins found from it, and the evidence of each.
#pragma once

#include <functional>

#include "landing/judge/evidence.hpp"
#include "landing/judge/map.hpp"
#include "landing/model/motion_space.hpp"

namespace ukemi::landing {

/// map_peaks over the motions of a space.
[[nodiscard]] PeakMap map_peaks(const Scene& scene, const MotionSpace& space, const MapOptions& options = {});

/// A basin: the best motion found near a local minimum of the grid, at MapOptions::tight.
struct Basin {
  MotionValues values;
  DrivenMotion play;
  double peak;
};
/// The distinct basins of the grid's best local minima, the best first; where the monitor stops it, those of finished
/// searches.
[[nodiscard]] std::vector<Basin> basins(const Scene& scene, const MotionSpace& space, const PeakMap& map,
                                        const MapOptions& options = {});

struct SurveyOptions {
  MapOptions map;            ///< its monitor: progress in the grid's rows
  Monitor basins, evidence;  ///< progress in searches of basins, and in their evidence
};

struct JudgedBasin {
  Basin basin;
  Evidence evidence;
};

/// A map of any kind of robot.
struct MappedPeaks {
  PeakMap map;
  double map_seconds = 0;  ///< time of the map
  /// Landings of the grid that could not be followed, that were not played, whose drive lost the joint, that broke a
  /// limit of the scene.
  long failed = 0, missing = 0, lost = 0, broken = 0;
};
/// The map made by `play`, with its time and counts.
[[nodiscard]] MappedPeaks mapped(const std::function<PeakMap()>& play);

struct Survey : MappedPeaks {
  Scene scene;
  std::vector<JudgedBasin> basins;  ///< the best first
};

[[nodiscard]] Survey survey(const Scene& scene, const MotionSpace& space, const SurveyOptions& options = {});

}  // namespace ukemi::landing

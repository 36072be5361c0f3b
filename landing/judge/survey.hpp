// The box of motions surveyed: its map, the basins that the map shows, and what each of them is worth.
#pragma once

#include <functional>

#include "landing/judge/evidence.hpp"
#include "landing/judge/map.hpp"
#include "landing/model/motion_space.hpp"

namespace ukemi::landing {

struct SurveyOptions {
  MapOptions map;            ///< its monitor: progress in the grid's rows
  Monitor basins, evidence;  ///< progress in basins found, and judged
};

struct JudgedBasin {
  Basin basin;
  Evidence evidence;
};

/// A map, whatever falls.
struct MappedPeaks {
  PeakMap map;
  double map_seconds = 0;  ///< that the map took
  /// Landings of the grid that could not be followed, that were not played, whose drive lost the joint.
  long failed = 0, missing = 0, lost = 0;
};
/// The map that `play` makes, timed and counted.
[[nodiscard]] MappedPeaks mapped(const std::function<PeakMap()>& play);

struct Survey : MappedPeaks {
  Scene scene;
  std::vector<JudgedBasin> basins;  ///< the best first
};

[[nodiscard]] Survey survey(const Scene& scene, const MotionSpace& space, const SurveyOptions& options = {});

}  // namespace ukemi::landing

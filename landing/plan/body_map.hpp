// Grid of the peaks of a robot of links over some variables of its motions, and the basins found from it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/error.hpp"
#include "landing/judge/survey.hpp"
#include "landing/plan/body_space.hpp"

namespace ukemi::landing {

/// End of a local search from a local minimum of the grid, over all variables, those fixed on the grid included.
struct BodyBasin {
  BodyMotion motion;
  double peak;      ///< at MapOptions::tight [m/s^2], with loads their `worth`
  double tolerant;  ///< the worst of execution_drops; infinite where one could not be followed or breaks a limit
};

/// A local minimum of the grid: its cell.
struct GridMinimum {
  BodyMotion motion;
  double peak;  ///< of the grid [m/s^2]
};

struct BodySurvey : MappedPeaks {
  BodyScene scene;
  std::vector<GridMinimum> minima;  ///< the best MapOptions::polished, the best first
  std::vector<BodyBasin> basins;    ///< distinct ones, the best first
};

/// A variable of the grid and its number of points.
struct GridAxis {
  std::string variable;          ///< of BodySpace
  std::optional<double> points;  ///< absent: 64, of three variables 24
};
/// MapOptions::cells of one to three variables; the others are fixed. Throws InputError "OPTION: ...".
std::vector<int> cells_of(const BodySpace& space, const std::vector<GridAxis>& axes, const std::string& option);

/// Values of a motion's variables, for MapOptions::slice. Throws InputError at `where` for a number of the motion that
/// is outside of the space.
Coordinates slice_of(const BodySpace& space, const BodyScene& scene, const BodyMotion& motion, const Location& where);
/// Of the held posture, its duration in the middle of its range.
Coordinates held_slice(const BodySpace& space, const BodyScene& scene);

/// Landings that break a limit have no value. `options.map.cells` and `slice` are of BodySpace's variables. Same inputs
/// and seed, same results. Throws InputError as BodySpace and `simulate`. Tests: test/legs/map.cpp.
[[nodiscard]] BodySurvey survey(const BodyScene& scene, const SurveyOptions& options);

}  // namespace ukemi::landing

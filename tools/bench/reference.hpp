// Reference landings, computed independently in extended precision (datasets/reference, see its README).
#pragma once

#include <string>
#include <vector>

#include "landing/model/motion.hpp"
#include "landing/model/scene.hpp"

namespace ukemi::landing {

struct ReferenceCase {
  std::string id;
  Scene scene;
  SeaParameters<double> sea;
  Motion motion;
  double peak;                     ///< max |ddr_0| from release to scene.t_end [m/s^2]
  double t_peak;                   ///< [s]
  std::string order;               ///< of the touchdowns, one letter for each: H, K, F
  std::vector<double> touchdowns;  ///< their times, from release [s]
};

/// Reads landing_cases.csv and landing_peaks.csv of a folder. Even ids: the paper's scene; odd ones: random robots.
/// Throws InputError.
std::vector<ReferenceCase> read_reference(const std::string& folder);

}  // namespace ukemi::landing

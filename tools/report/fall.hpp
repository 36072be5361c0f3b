// Figures of a fall: animation, postures at the peaks (Fig. 6 of [1]) and quantities over time (Fig. 7). A peak has the
// same number in all of them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "landing/judge/checked.hpp"
#include "tools/report/animation.hpp"
#include "tools/report/report.hpp"

namespace ukemi::tools {

/// One of the landings shown side by side.
template <class Landing>
struct FallOf {
  std::string name;  ///< "held at -45 deg"
  const Landing* landing;
  std::vector<Landing> ghosts;  ///< the same motion in other drops, drawn thin; of the paper's robot
};
using Fall = FallOf<landing::Landing>;
using BodyFall = FallOf<landing::BodyLanding>;

struct Falls {
  const landing::Scene& scene;
  const Actuator& actuator;     ///< ratings and rotor inertia for the figures
  std::vector<Fall> falls;      ///< the first is the requested one
  std::optional<double> limit;  ///< lower bound of the peak, see landing::TouchdownLimit [m/s^2]
  std::string data;             ///< name of the CSV with the numbers; empty: none
};

/// Adds animation and figures. Falls without a trajectory are left out.
void show(const Falls& falls, Report& report);
void show(const landing::BodyScene& scene, std::vector<BodyFall> falls, const std::string& data, Report& report);
/// A robot of links at release, every driven joint at the angle that the scene holds.
Figure drawing(const landing::BodyScene& scene);

/// Names of every figure of a fall.
std::vector<std::string> fall_figures();

}  // namespace ukemi::tools

// A fall as a reader sees it: the animation, the postures at the peaks (Fig. 6 of [1]) and what happens over time
// (Fig. 7), with one number for each peak in all of them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "landing/judge/checked.hpp"
#include "tools/report/report.hpp"

namespace ukemi::tools {

/// One of the landings that stand side by side.
struct Fall {
  std::string name;  ///< "held at -45 deg"
  const landing::Landing* landing;
  std::vector<landing::Landing> ghosts{};  ///< of the same motion in other drops, thin beside it
};

struct Falls {
  const landing::Scene& scene;
  const Actuator& actuator;     ///< its ratings and its motor's inertia are those of the figures
  std::vector<Fall> falls;      ///< the first is the one that the reader asked for
  std::optional<double> limit;  ///< of the peak, see landing::TouchdownLimit [m/s^2]
  std::string data;             ///< the CSV that holds the numbers; empty: none does
  enum class Figures { kDraw, kLeaveOut } figures = Figures::kDraw;  ///< kLeaveOut: nor the animation
};

/// The animation and the figures. Falls without a trajectory are left out.
void show(const Falls& falls, Report& report);

/// Kinetic and gravitational energy of both links, at a row of a trajectory [J].
double link_energy(const landing::Scene& scene, const landing::Sample& sample);

}  // namespace ukemi::tools

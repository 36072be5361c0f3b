// Figures of a fall: animation, postures at the peaks (Fig. 6 of [1]) and quantities over time (Fig. 7). A peak has the
// same number in all of them.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "landing/judge/checked.hpp"
#include "tools/report/report.hpp"

namespace ukemi::tools {

/// One of the landings shown side by side.
struct Fall {
  std::string name;  ///< "held at -45 deg"
  const landing::Landing* landing;
  std::vector<landing::Landing> ghosts{};  ///< the same motion in other drops, drawn thin
};

struct Falls {
  const landing::Scene& scene;
  const Actuator& actuator;     ///< ratings and rotor inertia for the figures
  std::vector<Fall> falls;      ///< the first is the requested one
  std::optional<double> limit;  ///< lower bound of the peak, see landing::TouchdownLimit [m/s^2]
  std::string data;             ///< name of the CSV with the numbers; empty: none
  enum class Figures { kDraw, kLeaveOut } figures = Figures::kDraw;  ///< and the animation
};

/// Adds animation and figures. Falls without a trajectory are left out.
void show(const Falls& falls, Report& report);

/// "①", as fall.js has it.
std::string circled(std::size_t n);
/// A figure over the time from release, with a cursor that all such figures share.
Figure over_time(const std::string& name, const std::string& y_label, std::vector<Series> series);
/// Marks the peaks with their numbers.
void add_marks(Panel& panel, const std::vector<landing::Peak>& peaks, int colour);
/// The first row at or after a time; rows are sorted by time.
template <class Sample>
const Sample& row_at(const std::vector<Sample>& rows, double t) {
  const auto after = std::lower_bound(rows.begin(), rows.end(), t, [](const Sample& s, double x) { return s.t < x; });
  return after == rows.end() ? rows.back() : *after;
}

/// Fig. 6 and 7 of [1] in one figure, for a file: the postures at the peaks above the acceleration.
Figure fall_picture(Panel postures, Figure acceleration);

/// Kinetic and potential energy of both links [J].
double link_energy(const landing::Scene& scene, const landing::Sample& sample);

/// Names of every figure of a fall.
std::vector<std::string> fall_figures();

}  // namespace ukemi::tools

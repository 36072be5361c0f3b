// A fall as a reader sees it: the animation, the postures at the peaks (Fig. 6 of [1]) and what happens over time
// (Fig. 7), with one number for each peak in all of them.
#pragma once

#include <algorithm>
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

/// "①", as the page's script writes it too.
std::string circled(std::size_t n);
/// A figure over the time from release, with a cursor that all such figures share.
Figure over_time(const std::string& name, const std::string& y_label, std::vector<Series> series);
/// The numbers of the peaks, where they are.
void add_marks(Panel& panel, const std::vector<landing::Peak>& peaks, int colour);
/// The row at a time, the one of the largest acceleration where there are two.
template <class Sample>
const Sample& row_at(const std::vector<Sample>& rows, double t) {
  const auto after = std::lower_bound(rows.begin(), rows.end(), t, [](const Sample& s, double x) { return s.t < x; });
  return after == rows.end() ? rows.back() : *after;
}

/// Fig. 6 and 7 of [1] in one picture, as a file: the postures at the peaks above the acceleration, on which their
/// numbers stand.
Figure fall_picture(Panel postures, Figure acceleration);

/// Kinetic and gravitational energy of both links, at a row of a trajectory [J].
double link_energy(const landing::Scene& scene, const landing::Sample& sample);

/// Names of every figure of a fall.
std::vector<std::string> fall_figures();

}  // namespace ukemi::tools

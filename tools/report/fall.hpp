// Figures of a fall: animation, postures at the peaks (Fig. 6 of [1]) and quantities over time (Fig. 7). A peak has the
// same number in all of them.
#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "landing/judge/checked.hpp"
#include "tools/report/animation.hpp"
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
};

/// Adds animation and figures. Falls without a trajectory are left out.
void show(const Falls& falls, Report& report);

/// A figure over the time from release, with a cursor that all such figures share.
Figure over_time(const std::string& name, const std::string& y_label, std::vector<Series> series);
/// The first row at or after a time; rows are sorted by time.
template <class Sample>
const Sample& row_at(const std::vector<Sample>& rows, double t) {
  const auto after = std::lower_bound(rows.begin(), rows.end(), t, [](const Sample& s, double x) { return s.t < x; });
  return after == rows.end() ? rows.back() : *after;
}

/// The curves, all but the first dashed.
std::vector<Series> dashed(std::vector<Series> curves);

/// A fall as the figures of any robot show it.
struct ShownFall {
  std::string name;
  const std::vector<landing::Peak>& peaks;
  Json animation;
  Series acceleration;
  std::function<void(Panel&, double t, double x)> draw;  ///< the robot at time t [s] with its origin at x [m]
};
struct ShownFalls {
  PointName point;
  std::string symbol, of;  ///< the acceleration: "|ddr_0|", "the thigh's centre of mass"
  /// Of postures [m]: distance to the next one; heights of number, peak and time; range. Whether the floor is level.
  struct Posture {
    double step, number, peak, time, low, high;
    bool floor;
  } posture;
  std::string posture_words, data;    ///< end of the postures' caption; name of the CSV with the numbers
  std::optional<double> limit = {};   ///< lower bound of the peak [m/s^2]
  std::size_t ghosts = 0;             ///< in the animation
  std::vector<ShownFall> falls = {};  ///< the first is the requested one
  std::vector<Figure> details = {};   ///< after the acceleration
};
void show(ShownFalls falls, Report& report);

/// Names of every figure of a fall.
std::vector<std::string> fall_figures();

}  // namespace ukemi::tools

#include "tools/report/trajectory.hpp"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <limits>

namespace ukemi::tools {

using namespace landing;

namespace {

/// A column of both files.
struct Column {
  std::string name;      ///< in trajectory.csv
  std::string in_words;  ///< for PlotJuggler: a place in its tree, and the unit
  std::function<double(const Sample&)> value;
};

const std::vector<Column>& columns() {
  static const std::vector<Column> all = [] {
    std::vector<Column> out = {{"t", "time[s]", &Sample::t},
                               {"x_0", "thigh/x[m]", &Sample::x0},
                               {"y_0", "thigh/y[m]", &Sample::y0},
                               {"phi_0", "thigh/pitch[rad]", &Sample::phi0},
                               {"phi_1", "joint/angle[rad]", &Sample::phi1},
                               {"phi_m", "motor/angle[rad]", &Sample::phi_m},
                               {"dx_0", "thigh/velocity_x[m*s^-1]", &Sample::dx0},
                               {"dy_0", "thigh/velocity_y[m*s^-1]", &Sample::dy0},
                               {"dphi_0", "thigh/pitch_rate[rad*s^-1]", &Sample::dphi0},
                               {"dphi_1", "joint/rate[rad*s^-1]", &Sample::dphi1},
                               {"dphi_m", "motor/rate[rad*s^-1]", &Sample::dphi_m},
                               {"ddx_0", "thigh/acceleration_x[m*s^-2]", &Sample::ddx0},
                               {"ddy_0", "thigh/acceleration_y[m*s^-2]", &Sample::ddy0},
                               {"acc", "thigh/acceleration_norm[m*s^-2]", &Sample::acc},
                               {"tau_sea", "joint/spring_torque[N*m]", &Sample::tau_sea},
                               {"phi_ref", "joint/reference[rad]", &Sample::phi_ref}};
    for (std::size_t j = 0; j < std::size_t(kPoints); ++j) {
      const std::string point = kPointNames[j];
      out.push_back({"f_" + point + "_x", "floor/" + point + "_force_x[N]", [j](auto& s) { return s.force[j].x(); }});
      out.push_back({"f_" + point + "_y", "floor/" + point + "_force_y[N]", [j](auto& s) { return s.force[j].y(); }});
    }
    return out;
  }();
  return all;
}

void header(CsvWriter& csv, std::string Column::*name) {
  std::vector<std::string> names;
  for (const Column& c : columns()) names.push_back(c.*name);
  csv.header(names);
}

}  // namespace

std::string trajectory_csv(const std::vector<Sample>& trajectory, const Run& run) {
  CsvWriter csv = run.csv();
  csv.comment(
      "t = 0 at release. Two rows with one t: left and right limit of an event. Units: s, m, rad, N, Nm; "
      "acc = |ddr_0|, m/s^2.");
  header(csv, &Column::name);
  for (const Sample& s : trajectory) {
    for (const Column& c : columns()) csv.cell(c.value(s));
    csv.end_row();
  }
  return csv.text();
}

std::string plotjuggler_csv(const std::vector<Sample>& trajectory) {
  CsvWriter csv;
  header(csv, &Column::in_words);
  double before = -std::numeric_limits<double>::infinity();
  for (Sample s : trajectory) {
    if (s.t <= before) s.t = std::nextafter(before, std::numeric_limits<double>::infinity());
    before = s.t;
    for (const Column& c : columns()) csv.cell(c.value(s));
    csv.end_row();
  }
  return csv.text();
}

}  // namespace ukemi::tools

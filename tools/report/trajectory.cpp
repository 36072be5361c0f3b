#include "tools/report/trajectory.hpp"

namespace ukemi::tools {

using namespace landing;

const RowColumns<Sample>& trajectory_columns() {
  static const RowColumns<Sample> all = [] {
    RowColumns<Sample> out = {{"t", "time[s]", &Sample::t},
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
      out.push_back({"f_" + point + "_x", "floor/" + point + "_force_x[N]", [j](auto& s) { return s.force[j][0]; }});
      out.push_back({"f_" + point + "_y", "floor/" + point + "_force_y[N]", [j](auto& s) { return s.force[j][1]; }});
    }
    return out;
  }();
  return all;
}

std::string trajectory_csv(const std::vector<Sample>& trajectory, const Run& run) {
  CsvWriter csv = run.csv();
  csv.comment(
      "t = 0 at release. Two rows with one t: left and right limit of an event. Units: s, m, rad, N, Nm; acc = "
      "|ddr_0|, m/s^2.");
  return rows_csv(csv, trajectory_columns(), &RowColumn<Sample>::name, trajectory);
}

}  // namespace ukemi::tools

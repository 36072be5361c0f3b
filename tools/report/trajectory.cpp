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

RowColumns<BodySample> trajectory_columns(const Robot& robot) {
  RowColumns<BodySample> out = {{"t", "time[s]", &BodySample::t}};
  const auto add = [&](const std::string& name, const std::string& plotjuggler_name, auto value) {
    out.push_back({name, plotjuggler_name, value});
  };
  // Element k of an array of the sample: of link, joint or contact k.
  const auto at = [](auto BodySample::*values, std::size_t k) {
    return [=](const BodySample& s) { return (s.*values)[k]; };
  };
  for (std::size_t k = 0; k < robot.links.size(); ++k) {
    const std::string& of = robot.links[k].name;
    add("x_" + of, of + "/x[m]", at(&BodySample::x, k)), add("y_" + of, of + "/y[m]", at(&BodySample::y, k));
    add("theta_" + of, of + "/angle[rad]", at(&BodySample::theta, k));
  }
  for (std::size_t k = 0; k < robot.joints.size(); ++k) {
    const std::string &of = robot.joints[k].name, in = "joints/" + of;
    add("phi_" + of, in + "/angle[rad]", at(&BodySample::phi, k));
    add("dphi_" + of, in + "/rate[rad*s^-1]", at(&BodySample::dphi, k));
    add("phi_m_" + of, in + "/motor_angle[rad]", at(&BodySample::phi_m, k));
    add("tau_" + of, in + "/torque[N*m]", at(&BodySample::tau, k));
    add("phi_ref_" + of, in + "/reference[rad]", at(&BodySample::phi_ref, k));
  }
  add("acc_x", "peak_point/acceleration_x[m*s^-2]", &BodySample::acc_x);
  add("acc_y", "peak_point/acceleration_y[m*s^-2]", &BodySample::acc_y);
  add("acc", "peak_point/acceleration_norm[m*s^-2]", &BodySample::acc);
  for (std::size_t k = 0; k < robot.contacts.size(); ++k) {
    const std::string& of = robot.contacts[k].name;
    add("f_" + of + "_x", "floor/" + of + "_force_x[N]", at(&BodySample::force_x, k));
    add("f_" + of + "_y", "floor/" + of + "_force_y[N]", at(&BodySample::force_y, k));
  }
  add("energy", "links/energy[J]", &BodySample::energy);
  return out;
}

}  // namespace ukemi::tools

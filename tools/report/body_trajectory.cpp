#include "tools/report/body.hpp"

namespace ukemi::tools {

using namespace landing;

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

std::string trajectory_csv(const BodyScene& scene, const BodyLanding& landing, const Run& run) {
  CsvWriter csv = run.csv();
  csv.comment(
      "t = 0 at release. Two rows with one t: left and right limit of an event. x, y, theta: each link's origin and "
      "absolute angle; acc: of the point that counts. Units: s, m, rad, N, Nm, m/s^2.");
  return rows_csv(csv, trajectory_columns(scene.robot), &RowColumn<BodySample>::name, landing.trajectory);
}

}  // namespace ukemi::tools

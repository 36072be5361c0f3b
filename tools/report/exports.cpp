#include "tools/report/exports.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "landing/model/waypoints.hpp"
#include "tools/report/trajectory.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

/// A number as YAML 1.1 knows one: with a point, or "1e-05" is a text and "0" an integer.
std::string yaml_number(double value) {
  std::string text = shortest(value);
  if (text.find('.') == text.npos) text.insert(std::min(text.find('e'), text.size()), ".0");
  return text;
}

/// A trajectory_msgs/msg/JointTrajectory of one joint.
std::string joint_trajectory(const std::string& joint, const std::vector<Waypoint>& points,
                             const std::string& comments) {
  CsvWriter head;
  head.comment(comments);
  std::string text =
      head.text() + fmt::format(
                        "header:\n  stamp: {{sec: 0, nanosec: 0}}\n  frame_id: \"\"\njoint_names: [\"{}\"]\n"
                        "points:\n",
                        joint);
  for (const Waypoint& p : points) {
    constexpr long long kSecond = 1'000'000'000;
    const long long nanoseconds = std::llround(p.t * 1e9);
    text += fmt::format(
        "- positions: [{}]\n  velocities: [{}]\n  accelerations: [{}]\n  time_from_start: {{sec: {}, nanosec: {}}}\n",
        yaml_number(p.phi), yaml_number(p.dphi), yaml_number(p.ddphi), nanoseconds / kSecond, nanoseconds % kSecond);
  }
  return text;
}

/// What the reader of both messages must know.
constexpr const char* kRos2Words =
    "trajectory_msgs/msg/JointTrajectory of phi_ref, the reference of the joint (0: leg straight; below 0: foot "
    "backward). Units: rad, rad/s, rad/s^2.\n"
    "Between two points: the quintic through their positions, velocities and accelerations, as "
    "joint_trajectory_controller takes it with interpolation_method: splines. After the last point its position is "
    "held.\n";

std::string landing_message(const Exports& exports, const Motion& m, double start, const Run& run) {
  const Motion played = started_at(m, start);
  std::vector<Waypoint> points = waypoints(landing_of(played, played.phi_i, 0.0));
  if (m.reposition) points.erase(points.begin());
  std::string words = run.provenance_text() + kRos2Words +
                      fmt::format("{} points: the motion {}.\n", points.size(),
                                  has_bumps(m) ? fmt::format("within {:g} rad", kSplineMisfit)
                                               : "itself, its duration rounded to 1 ns") +
                      "Send it when the first touchdown is detected; a zero stamp means now.";
  if (m.reposition)
    words +=
        "\nIt has no point at its start: the floor may cut the move in the air short, and the controller goes on from "
        "where its reference is.";
  if (m.gain_p != 1 || m.gain_d != 1)
    words += fmt::format("\nNot in this message: from its start on K_p times {} and K_d times {}.", m.gain_p, m.gain_d);
  return joint_trajectory(exports.joint, points, words);
}

std::string reposition_message(const Exports& exports, const Motion& m, const Run& run) {
  const Reposition& r = *m.reposition;
  std::vector<Waypoint> points = waypoints(reposition_of(m));
  for (Waypoint& p : points) p.t += r.from;
  if (r.from > 0) points.insert(points.begin(), {0, r.phi, 0, 0});
  return joint_trajectory(exports.joint, points,
                          run.provenance_text() + kRos2Words +
                              "The move in the air: send it at release; a zero stamp means now. motion_ros2.yaml takes "
                              "its place at the touchdown, whether it is over or not.");
}

}  // namespace

bool Exports::has(Format format) const { return std::find(formats.begin(), formats.end(), format) != formats.end(); }

std::map<std::string, std::string> exported(const Exports& exports, const Actuator& actuator, const RigLink& link,
                                            const Run& run) {
  std::map<std::string, std::string> out;
  const std::string made_by = run.provenance_text();
  if (exports.has(Exports::Format::kMjcf)) out["actuator.mjcf.xml"] = mjcf(actuator, link, exports.joint, made_by);
  if (exports.has(Exports::Format::kUrdf)) out["actuator.urdf.xml"] = urdf(actuator, link, exports.joint, made_by);
  return out;
}

std::map<std::string, std::string> exported(const Exports& exports, const Motion& motion, double start,
                                            const Landing& landing, const Run& run) {
  std::map<std::string, std::string> out;
  if (exports.has(Exports::Format::kRos2)) {
    out["motion_ros2.yaml"] = landing_message(exports, motion, start, run);
    if (moves_in_air(motion, start)) out["reposition_ros2.yaml"] = reposition_message(exports, motion, run);
  }
  if (exports.has(Exports::Format::kPlotJuggler) && !landing.trajectory.empty())
    out["plotjuggler.csv"] = plotjuggler_csv(landing.trajectory);
  return out;
}

}  // namespace ukemi::tools

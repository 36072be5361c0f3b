#include "tools/report/exports.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "landing/model/waypoints.hpp"
#include "tools/report/body.hpp"
#include "tools/report/landing_doubts.hpp"
#include "tools/report/trajectory.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

/// A number as a YAML 1.1 float, with a decimal point: "1e-05" would be a string and "0" an integer.
std::string yaml_number(double value) {
  std::string text = shortest(value);
  if (text.find('.') == text.npos) text.insert(std::min(text.find('e'), text.size()), ".0");
  return text;
}

/// Motion of a joint with the joint's name and angle convention in messages.
struct NamedMotion {
  std::string joint;
  Motion motion;
  double sign = 1, zero = 0;  ///< angle in messages: zero + sign phi [rad]
  bool has_own_angle() const { return sign < 0 || zero != 0; }
};
using NamedMotions = std::vector<NamedMotion>;

/// f(0), ..., f(n - 1) separated by commas.
template <class F>
std::string listed(std::size_t n, F&& f) {
  std::string out;
  for (std::size_t i = 0; i < n; ++i) out += (i ? ", " : "") + f(i);
  return out;
}

/// A trajectory_msgs/msg/JointTrajectory as YAML. `points`: of each joint, at common times.
std::string joint_trajectory(const NamedMotions& joints, const std::vector<std::vector<Waypoint>>& points,
                             const std::string& comments) {
  CsvWriter head;
  head.comment(comments);
  const std::size_t n = joints.size();
  std::string text =
      head.text() +
      fmt::format("header:\n  stamp: {{sec: 0, nanosec: 0}}\n  frame_id: \"\"\njoint_names: [{}]\npoints:\n",
                  listed(n, [&](std::size_t i) { return "\"" + joints[i].joint + "\""; }));
  for (std::size_t k = 0; k < points[0].size(); ++k) {
    constexpr long long kSecond = 1'000'000'000;
    const long long nanoseconds = std::llround(points[0][k].t * 1e9);
    const auto values = [&](double Waypoint::*value) {
      const bool angle = value == &Waypoint::phi;
      return listed(n, [&](std::size_t i) {
        return yaml_number((angle ? joints[i].zero : 0.0) + joints[i].sign * points[i][k].*value);
      });
    };
    text += fmt::format(
        "- positions: [{}]\n  velocities: [{}]\n  accelerations: [{}]\n  time_from_start: {{sec: {}, nanosec: {}}}\n",
        values(&Waypoint::phi), values(&Waypoint::dphi), values(&Waypoint::ddphi), nanoseconds / kSecond,
        nanoseconds % kSecond);
  }
  return text;
}

/// Which angles differ from those of ukemi's files.
std::string own_angle_words(const NamedMotions& joints) {
  std::string out;
  for (const NamedMotion& j : joints)
    if (j.has_own_angle())
      out += fmt::format("{}q = {}{}phi of {}", out.empty() ? "" : ", ", j.zero == 0 ? "" : shortest(j.zero) + " rad ",
                         j.sign > 0 ? "+ " : (j.zero == 0 ? "-" : "- "), j.joint);
  return out.empty() ? "" : "Positions are the angles q of the robot's description: " + out + ".\n";
}

/// Comments that both messages begin with.
std::string ros2_words(const NamedMotions& joints) {
  return fmt::format(
      "trajectory_msgs/msg/JointTrajectory of phi_ref, {}. Units: rad, rad/s, rad/s^2.\n"
      "Between two points: the quintic through their positions, velocities and accelerations, as "
      "joint_trajectory_controller takes it with interpolation_method: splines. After the last point its position is "
      "held.\n{}",
      joints.size() == 1 ? "the reference of the joint (0: leg straight; below 0: foot backward)"
                         : "the references of the joints (0: a link in line with its parent)",
      own_angle_words(joints));
}

/// Factors of the gains, for which the message has no field.
std::string gains_words(const NamedMotions& joints) {
  std::string out;
  for (const auto& [joint, m, sign, zero] : joints)
    if (m.gain_p != 1 || m.gain_d != 1)
      out += fmt::format("{}{}K_p times {} and K_d times {}", out.empty() ? "" : "; ",
                         joints.size() > 1 ? "of " + joint + " " : "", m.gain_p, m.gain_d);
  return out.empty() ? "" : "\nNot in this message: from its start on " + out + ".";
}

std::string landing_message(const NamedMotions& joints, double start, const Run& run) {
  std::vector<ReferencePiece<double>> pieces;
  for (const NamedMotion& j : joints) {
    const Motion started = started_at(j.motion, start);
    pieces.push_back(landing_of(started, started.phi_i, 0.0));
  }
  std::vector<std::vector<Waypoint>> points = waypoints(pieces);
  const auto any_joint = [&](auto&& predicate) { return std::any_of(joints.begin(), joints.end(), predicate); };
  const bool repositions = any_joint([](auto& j) { return j.motion.reposition.has_value(); });
  for (auto& of_joint : points)
    if (repositions) of_joint.erase(of_joint.begin());
  std::string words =
      run.provenance_text() + ros2_words(joints) +
      fmt::format("{} points: the motion {}.\n", points[0].size(),
                  any_joint([](auto& j) { return has_bumps(j.motion); }) ? fmt::format("within {:g} rad", kSplineMisfit)
                                                                         : "itself, its duration rounded to 1 ns") +
      "Send it when the first touchdown is detected; a zero stamp means now.";
  if (repositions)
    words +=
        "\nIt has no point at its start: the floor may cut the move in the air short, and the controller goes on from "
        "where its reference is.";
  return joint_trajectory(joints, points, words + gains_words(joints));
}

/// Message of the moves in the air; a joint without one is held meanwhile.
std::string reposition_message(const NamedMotions& joints, const Run& run) {
  const auto moving = std::find_if(joints.begin(), joints.end(), [](auto& j) { return j.motion.reposition; });
  std::vector<ReferencePiece<double>> pieces;
  for (const NamedMotion& j : joints) {
    ReferencePiece<double> constant = reposition_of(moving->motion);
    constant.a = constant.b = j.motion.phi_i;
    pieces.push_back(j.motion.reposition ? reposition_of(j.motion) : constant);
  }
  return joint_trajectory(joints, waypoints(pieces),
                          run.provenance_text() + ros2_words(joints) +
                              "The move in the air: send it at release; a zero stamp means now. motion_ros2.yaml takes "
                              "its place at the touchdown, whether it is over or not.");
}

/// Files of motions and of the trajectory of their landing.
template <class Row>
std::map<std::string, std::string> motion_files(const Exports& exports, const NamedMotions& joints, double start,
                                                const RowColumns<Row>& columns, const std::vector<Row>& rows,
                                                const Run& run) {
  std::map<std::string, std::string> out;
  if (exports.has(Exports::Format::kRos2)) {
    out["motion_ros2.yaml"] = landing_message(joints, start, run);
    if (std::any_of(joints.begin(), joints.end(), [&](auto& j) { return moves_in_air(j.motion, start); }))
      out["reposition_ros2.yaml"] = reposition_message(joints, run);
  }
  if (exports.has(Exports::Format::kPlotJuggler) && !rows.empty())
    out["plotjuggler.csv"] = plotjuggler_csv(columns, rows);
  return out;
}

constexpr const char* kKnee = "knee";

}  // namespace

bool Exports::has(Format format) const { return std::find(formats.begin(), formats.end(), format) != formats.end(); }

std::map<std::string, std::string> exported(const Exports& exports, const Actuator& actuator, const RigLink& link,
                                            const Run& run) {
  std::map<std::string, std::string> out;
  const std::string made_by = run.provenance_text();
  if (exports.has(Exports::Format::kMjcf))
    out["actuator.mjcf.xml"] = mjcf(actuator, link, exports.joint.value_or(kKnee), made_by);
  if (exports.has(Exports::Format::kUrdf))
    out["actuator.urdf.xml"] = urdf(actuator, link, exports.joint.value_or(kKnee), made_by);
  return out;
}

std::map<std::string, std::string> exported(const Exports& exports, const Motion& motion, double start,
                                            const Landing& landing, const Run& run) {
  return motion_files(exports, {{exports.joint.value_or(kKnee), motion}}, start, trajectory_columns(),
                      landing.trajectory, run);
}

std::map<std::string, std::string> exported(const Exports& exports, const BodyScene& scene, const BodyMotion& motion,
                                            const BodyLanding& landing, const Run& run) {
  NamedMotions joints;
  for (std::size_t i = 0; i < motion.size(); ++i)
    if (const Joint& j = scene.robot.joints[i]; j.driven())
      joints.push_back({exports.joint.value_or(j.q_name.empty() ? j.name : j.q_name), motion[i], j.q_sign, j.q_zero});
  return motion_files(exports, joints, expected_start(scene, landing), trajectory_columns(scene.robot),
                      landing.trajectory, run);
}

}  // namespace ukemi::tools

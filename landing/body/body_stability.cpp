#include "landing/body/body_stability.hpp"

#include <cmath>

#include "common/drive_stability.hpp"
#include "landing/body/body_posture.hpp"
#include "landing/model/motion.hpp"

namespace ukemi::landing {

namespace {

/// d(joint accelerations) / d(joint torques) at rest with the joints at phi, in the order of Body::joint.
Eigen::MatrixXd joint_compliance(const Robot& robot, const Body<double, kAny>& body, double pitch,
                                 const std::vector<double>& phi) {
  const TreePose<double, kAny.bodies> pose = rest_pose(robot, body, pitch, phi);
  Body<double, kAny> railed = body;
  railed.rail = {std::cos(robot.rail_direction), std::sin(robot.rail_direction)};
  Eigen::MatrixXd out(int(body.joints), int(body.joints));
  const auto relative = [](const TreeJoint& joint, const auto& of_links) {
    return of_links[std::size_t(joint.child)] - (joint.parent < 0 ? 0 : of_links[std::size_t(joint.parent)]);
  };
  for (int k = 0; k < body.joints; ++k) {
    const TreeJoint& pushed = body.joint[std::size_t(k)];
    TreeLoads<double, kAny.bodies> load;
    load.torque[std::size_t(pushed.child)] += 1;
    if (pushed.parent >= 0) load.torque[std::size_t(pushed.parent)] -= 1;
    const auto acc = solve(railed, pose, load, {0.0, 0.0}, 0.0);
    for (int i = 0; i < body.joints; ++i) out(i, k) = relative(body.joint[std::size_t(i)], acc.alpha);
  }
  return out;
}

/// `sea`: of the joint, with the gains in effect.
LinearJoint linear(const Joint& j, const SeaParameters<double>& sea) {
  switch (j.kind) {
    case DriveKind::kElastic:
      return {&sea, j.parallel_stiffness, 0};
    case DriveKind::kGeared:
      return {nullptr, j.parallel_stiffness + sea.k_p, sea.k_d + sea.viscous};
    default:
      return {nullptr, j.parallel_stiffness + j.stiffness, j.damping};
  }
}

}  // namespace

std::optional<BodyInstability> instability(const BodyScene& scene, const BodyMotion& motion) {
  const Robot& robot = scene.robot;
  const Body<double, kAny> body = body_of<kAny>(robot);
  if (body.joints == 0) return std::nullopt;
  std::optional<BodyInstability> worst;
  for (const bool landing : {false, true}) {
    std::vector<double> phi;
    std::vector<SeaParameters<double>> sea;
    for (std::size_t i = 0; i < robot.joints.size(); ++i) {
      const Joint& j = robot.joints[i];
      phi.push_back(!j.driven() ? j.phi : landing ? motion[i].phi_f : motion[i].phi_i);
      sea.push_back(landing && j.driven() ? with_landing_gains(j.sea, motion[i]) : j.sea);
    }
    std::vector<LinearJoint> joints;
    for (int i = 0; i < body.joints; ++i) {
      const auto index = std::size_t(body.joint[std::size_t(i)].joint);
      joints.push_back(linear(robot.joints[index], sea[index]));
    }
    const Growth g = growth(joints, joint_compliance(robot, body, scene.drop.pitch, phi));
    if (g.rate > (worst ? worst->rate : 0)) worst = {g.rate, body.joint[std::size_t(g.joint)].joint, landing};
  }
  return worst;
}

}  // namespace ukemi::landing

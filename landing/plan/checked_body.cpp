#include "landing/plan/checked_body.hpp"

#include <algorithm>
#include <cmath>

#include "common/drive_stability.hpp"
#include "landing/model/motion.hpp"
#include "landing/plan/body_posture.hpp"

namespace ukemi::landing {

namespace {

/// Perturbs the numbers by 1e-6 relative.
void perturb(BodyScene& s, Random& random) {
  const auto vary = [&](double& x) { landing::perturb(x, random); };
  for (Link& l : s.robot.links) vary(l.mass), vary(l.inertia_com), vary(l.at.along), vary(l.com.along);
  for (ContactPoint& c : s.robot.contacts)
    for (double* x : {&c.law.stiffness, &c.law.damping_normal, &c.law.damping_tangential}) vary(*x);
  for (double* x : {&s.drop.height, &s.drop.forward_speed, &s.drop.pitch, &s.drop.pitch_rate, &s.robot.gravity})
    vary(*x);
}

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

CheckedBody checked_body(const BodyScene& scene, const BodyMotion& motion, const SimulateOptions& options, double rate,
                         int draws) {
  CheckedBody out{scene, motion, simulate(scene, motion, options, rate), {}, options.accuracy};
  if (out.landing.end == End::kFailed) return out;
  const auto play = [&](double accuracy, Random* random) -> std::optional<double> {
    BodyScene s = scene;
    if (random) perturb(s, *random);
    SimulateOptions tighter = options;
    tighter.accuracy = accuracy;
    const BodyLanding l = simulate(s, motion, tighter);
    return l.end == End::kFailed ? std::nullopt : std::optional(l.peak);
  };
  out.sensitivity = sensitivity(out.landing.peak, options.accuracy, play, draws, 1);
  return out;
}

std::optional<BodyLanding> held_landing(const CheckedBody& c, double rate) {
  if (std::none_of(c.motion.begin(), c.motion.end(), [](const Motion& m) { return moves(m); })) return std::nullopt;
  BodyLanding held = simulate(c.scene, held_posture(c.scene), {.accuracy = c.accuracy}, rate);
  return no_landing(held.end) ? std::nullopt : std::optional(std::move(held));
}

}  // namespace ukemi::landing

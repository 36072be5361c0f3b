#include "landing/plan/checked_body.hpp"

#include <algorithm>
#include <cmath>

#include "common/drive_stability.hpp"
#include "landing/model/motion.hpp"
#include "landing/plan/body_posture.hpp"

namespace ukemi::landing {

namespace {

/// Every number moved by 1e-6 relative.
void move_a_little(BodyScene& s, Random& random) {
  const auto move = [&](double& x) { landing::move_a_little(x, random); };
  for (Link& l : s.robot.links) move(l.mass), move(l.inertia_com), move(l.at.along), move(l.com.along);
  for (ContactPoint& c : s.robot.contacts)
    for (double* x : {&c.law.stiffness, &c.law.damping_normal, &c.law.damping_tangential}) move(*x);
  for (double* x : {&s.drop.height, &s.drop.forward_speed, &s.drop.pitch, &s.drop.pitch_rate, &s.robot.gravity})
    move(*x);
}

/// The joints' accelerations per torque, the robot at rest with its joints at phi; in the order of Body::joint.
Eigen::MatrixXd joint_compliance(const Robot& robot, const Body<double, kAny>& body, double pitch,
                                 const std::vector<double>& phi) {
  const TreePose<double, kAny.bodies> pose = at_rest_in(robot, body, pitch, phi);
  Body<double, kAny> railed = body;
  railed.rail = {std::cos(robot.rail_direction), std::sin(robot.rail_direction)};
  Eigen::MatrixXd out(int(body.joints), int(body.joints));
  const auto across = [](const JointPlace& at, const auto& of) {
    return of[std::size_t(at.child)] - (at.parent < 0 ? 0 : of[std::size_t(at.parent)]);
  };
  for (int k = 0; k < body.joints; ++k) {
    const JointPlace& pushed = body.joint[std::size_t(k)];
    TreeLoads<double, kAny.bodies> load;
    load.torque[std::size_t(pushed.child)] += 1;
    if (pushed.parent >= 0) load.torque[std::size_t(pushed.parent)] -= 1;
    const auto acc = solve(railed, pose, load, {0.0, 0.0}, 0.0);
    for (int i = 0; i < body.joints; ++i) out(i, k) = across(body.joint[std::size_t(i)], acc.alpha);
  }
  return out;
}

/// `sea`: of the joint, with the gains that act.
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
      const auto of = std::size_t(body.joint[std::size_t(i)].joint);
      joints.push_back(linear(robot.joints[of], sea[of]));
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
    if (random) move_a_little(s, *random);
    SimulateOptions tighter = options;
    tighter.accuracy = accuracy;
    const BodyLanding l = simulate(s, motion, tighter);
    return l.end == End::kFailed ? std::nullopt : std::optional(l.peak);
  };
  out.sensitivity = sensitivity(out.landing.peak, options.accuracy, play, draws, 1);
  return out;
}

std::optional<BodyLanding> held_beside(const CheckedBody& c, double rate) {
  if (std::none_of(c.motion.begin(), c.motion.end(), [](const Motion& m) { return moves(m); })) return std::nullopt;
  BodyLanding held = simulate(c.scene, held_posture(c.scene), {.accuracy = c.accuracy}, rate);
  return no_landing(held.end) ? std::nullopt : std::optional(std::move(held));
}

}  // namespace ukemi::landing

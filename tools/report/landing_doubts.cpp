#include "tools/report/landing_doubts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/degrees.hpp"
#include "landing/body/load.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

using Doubts = std::vector<std::string>;

/// Growth at `rate` [1/s] of disturbances about phi [rad]; prefix `whose`.
std::string growth_words(const std::string& whose, double phi, double rate, double tau_max) {
  return fmt::format(
      "{}the drive is unstable on this robot: in flight, at {:.4g} deg, a disturbance grows e-fold every {:.2g} s{}",
      whose, phi * kDegrees, 1 / rate,
      std::isfinite(tau_max) ? ", up to the torque limit" : ", and no torque limit stops it");
}

/// Speed demanded of a joint's motor [rad/s]: the larger of its reference's and its own.
double speed_of(const Motion& motion, double start, const JointDemands& d) {
  return std::max(peak_reference_rate(motion, start), d.motor_speed);
}

/// Warns of link origins without a contact that go below the floor.
void doubt_hinges(const BodyScene& scene, const BodyLanding& l, Doubts& out) {
  constexpr double kMaxDepth = 0.01;  // allows for the radius of a hinge [m]
  const Robot& robot = scene.robot;
  if (!scene.touches() || scene.slope != 0) return;
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const Link& link = robot.links[i];
    const auto is_at_hinge = [&](const ContactPoint& c) {
      const auto at = [&](int of, const landing::Place& p) {
        return c.link == of && c.at.along == p.along && c.at.across == p.across;
      };
      return at(int(i), {}) || (link.parent >= 0 && at(link.parent, link.at));
    };
    if (std::any_of(robot.contacts.begin(), robot.contacts.end(), is_at_hinge)) continue;
    double lowest = 0;
    for (const BodySample& s : l.trajectory) lowest = std::min(lowest, s.y[i]);
    const Joint* joint = robot.joint_of(int(i));
    if (lowest < -kMaxDepth)
      out.push_back(fmt::format("{} goes {:.3g} m below the floor: no contact is there",
                                joint ? "joint " + joint->name : "the origin of " + link.name, -lowest));
  }
}

}  // namespace

std::vector<std::string> landing_doubts(const Landing& l) {
  if (!l.joint_lost) return {};
  return {fmt::format(
      "the joint turns from {:.4g} to {:.4g} deg: the drive has lost it, and the peak is that of a link that whirls",
      l.demands.phi_min * kDegrees, l.demands.phi_max * kDegrees)};
}

std::vector<std::string> landing_doubts(const Ratings& r) {
  Doubts out;
  if (r.too_fast())
    out.push_back(fmt::format(
        "the robot could not follow: reference rate {:.3g} rad/s, motor speed {:.3g} rad/s; rated {:.3g} rad/s",
        r.reference_rate, r.demands.motor_speed, *r.speed_max));
  if (r.too_strong())
    out.push_back(fmt::format("the robot could not follow: motor torque {:.3g} Nm; rated {:.3g} Nm",
                              r.demands.motor_torque, *r.motor_torque_max));
  return out;
}

std::vector<std::string> landing_doubts(const std::optional<Instability>& i, double tau_max) {
  return i ? Doubts{growth_words("", i->phi, i->rate, tau_max)} : Doubts{};
}

std::vector<ExceededRating> exceeded_ratings(const BodyScene& scene, const BodyMotion& motion, const BodyLanding& l) {
  const Robot& robot = scene.robot;
  const double start = expected_start(scene, l);
  std::vector<ExceededRating> out;
  for (std::size_t i = 0; i < l.demands.size(); ++i) {
    const Joint& joint = robot.joints[i];
    if (!joint.driven()) continue;
    const double speed = speed_of(motion[i], start, l.demands[i]), torque = l.demands[i].motor_torque;
    if (joint.speed_max && speed > rating_limit(*joint.speed_max))
      out.push_back({&joint, speed, *joint.speed_max, "rad/s", "at"});
    if (joint.motor_torque_max && torque > torque_limit(joint, *joint.motor_torque_max))
      out.push_back({&joint, torque, *joint.motor_torque_max, "Nm", "with"});
  }
  return out;
}

double expected_start(const BodyScene& scene, const BodyLanding& landing) {
  return landing.contacts.first() + scene.detection_delay;
}

std::vector<std::string> landing_doubts(const BodyScene& scene, const BodyMotion& motion, const BodyLanding& l) {
  Doubts out;
  const std::vector<Joint>& joints = scene.robot.joints;
  if (const auto unstable = instability(scene, motion)) {
    const auto i = std::size_t(unstable->joint);
    const double phi = !joints[i].driven() ? joints[i].phi : unstable->landing ? motion[i].phi_f : motion[i].phi_i;
    out.push_back(growth_words(joints[i].name + ": ", phi, unstable->rate, joints[i].sea.tau_max));
  }
  for (std::size_t i = 0; i < l.demands.size(); ++i)
    if (std::max(std::abs(l.demands[i].phi_min), std::abs(l.demands[i].phi_max)) >
        (joints[i].driven() ? 1 : 2) * kLostJoint)
      out.push_back(fmt::format("joint {} turns from {:.4g} to {:.4g} deg: the peak is that of a link that whirls",
                                joints[i].name, l.demands[i].phi_min * kDegrees, l.demands[i].phi_max * kDegrees));
  doubt_hinges(scene, l, out);
  for (const ExceededRating& b : exceeded_ratings(scene, motion, l))
    out.push_back(fmt::format("the robot could not follow: {} {} {:.3g} {}; rated {:.3g} {}", b.joint->name,
                              b.preposition, b.value, b.unit, b.rating, b.unit));
  return out;
}

}  // namespace ukemi::tools

#include "landing/body/by_links.hpp"

#include <algorithm>
#include <cmath>

#include "landing/body/load.hpp"

namespace ukemi::landing {

namespace {

/// Sets every number of a robot that by_links has made.
void set_numbers(Robot& robot, const TwoLink<double>& two, const ContactLaw& law) {
  const double l = two.link_length;
  robot.gravity = two.gravity;
  for (std::size_t i = 0; i < 2; ++i) {
    Link& link = robot.links[i];
    link.mass = two.mass[i], link.inertia_com = two.inertia_com[i], link.com = {l / 2, 0};
  }
  robot.links[1].at = {l, 0};
  robot.peak = robot.links[0].com;
  for (ContactPoint& c : robot.contacts) c.law = law, c.at.along = c.name == kPointNames[kHip] ? 0 : l;
}

}  // namespace

Robot by_links(const TwoLink<double>& two, const std::array<bool, kPoints>& contacts, const ContactLaw& law) {
  Robot out;
  out.links = {{.name = "thigh", .parent = -1}, {.name = "shank", .parent = 0}};
  for (int i = 0; i < kPoints; ++i)
    if (contacts[std::size_t(i)]) out.contacts.push_back({.name = kPointNames[std::size_t(i)], .link = i == kFoot});
  out.joints.push_back({.name = "knee", .child = 1});
  set_numbers(out, two, law);
  return out;
}

TwoLinkLanding::TwoLinkLanding() {
  scene.robot = by_links({{1, 1}, {1, 1}, 1, 1}, contacts_, {.stiffness = 1});
  scene.search.resize(1);
}

TwoLinkLanding& reused_landing(int i) {
  thread_local std::array<TwoLinkLanding, kReusedLandings> all;
  return all[std::size_t(i)];
}

void TwoLinkLanding::set_scene(const Scene& s) {
  constexpr std::array<bool, kPoints> kAll{true, true, true};
  const std::array<bool, kPoints>& contacts = s.touches() ? s.contacts : kAll;  // the drop's height counts from them
  const Floor<double> f = s.floor.value_or(Floor<double>{1, 0, 0});
  const ContactLaw law{
      .stiffness = f.stiffness, .damping_normal = f.damping_normal, .damping_tangential = f.damping_tangential};
  if (contacts != contacts_)
    contacts_ = contacts, scene.robot = by_links(s.robot, contacts, law);
  else
    set_numbers(scene.robot, s.robot, law);
  scene.floor = s.touches();
  scene.drop = s.drop, scene.drop_at = scene.robot.links[0].com;
  scene.detection_delay = s.detection_delay, scene.t_end = s.t_end;
}

int TwoLinkLanding::point(int contact) const {
  int point = 0;
  for (int n = 0; contact >= 0 && point < kPoints; ++point)
    if (contacts_[std::size_t(point)] && n++ == contact) return point;
  return -1;
}

void TwoLinkLanding::set_limits(const Limits& l) {
  using Kind = Load::Kind;
  const Robot& robot = scene.robot;
  const auto add = [&](Kind kind, std::size_t index, double rating, std::array<double, 2> phi = {}) {
    scene.loads.push_back(limit(robot, kind, index, rating, phi));
  };
  scene.loads.clear(), rate_load_ = -1;
  for (std::size_t i = 0; i < robot.contacts.size(); ++i)
    if (scene.floor && l.forbidden[std::size_t(point(int(i)))]) add(Kind::kTouch, i, 0);
  if (l.joint_stops()) {
    constexpr double kNoStop = 100;  // [rad]
    add(Kind::kAngle, 0, 0, {std::max(l.joint[0], -kNoStop), std::min(l.joint[1], kNoStop)});
  }
  if (std::isfinite(l.motor_speed)) add(Kind::kMotorSpeed, 0, l.motor_speed);
  if (std::isfinite(l.motor_torque)) add(Kind::kMotorTorque, 0, l.motor_torque);
  reference_rate_ = l.reference_rate;
  if (std::isfinite(reference_rate_)) rate_load_ = int(scene.loads.size()), add(Kind::kReferenceRate, 0, 0);
  scene.ends_broken = !scene.loads.empty();
}

void TwoLinkLanding::set_drive(const SeaParameters<double>& sea, const Motion& m) {
  scene.robot.joints[0].sea = sea;
  motion[0] = m;
  // Only a motion that interrupts the move in the air may break this limit: see Limits::reference_rate.
  if (rate_load_ >= 0) scene.loads[std::size_t(rate_load_)].rating = std::max(reference_rate_, peak_reference_rate(m));
}

LandingPeak TwoLinkLanding::outcome(const RunEnd& run) const {
  LandingPeak out = run;
  out.contacts.renumber([this](int contact) { return point(contact); });
  if (run.end == End::kTimeLimit && !std::isfinite(run.contacts.first())) out.end = End::kNoContact;
  return out;
}

}  // namespace ukemi::landing

// Robots of links that several tests play.
#pragma once

#include <string>

#include "common/actuator.hpp"
#include "landing/body/body_scene.hpp"

namespace legs {

using namespace ukemi;
using namespace ukemi::landing;

inline BodyScene shipped(const std::string& name) {
  return read_body_scene(UKEMI_DATASETS "/scenes/" + name + ".toml");
}

/// The paper's scene in the long form.
inline BodyScene long_paper(const Scene& s, const Actuator& a) {
  BodyScene out;
  const double l = s.robot.link_length;
  Robot& r = out.robot;
  r.gravity = s.robot.gravity;
  r.links = {{.name = "thigh", .mass = s.robot.mass[0], .inertia_com = s.robot.inertia_com[0], .com = {l / 2, 0}},
             {.name = "shank",
              .parent = 0,
              .at = {l, 0},
              .mass = s.robot.mass[1],
              .inertia_com = s.robot.inertia_com[1],
              .com = {l / 2, 0}}};
  r.peak = r.links[0].com;
  const ContactLaw law{.stiffness = s.floor->stiffness,
                       .damping_normal = s.floor->damping_normal,
                       .damping_tangential = s.floor->damping_tangential};
  r.contacts = {{"hip", 0, {0, 0}, law, {}}, {"knee", 0, {l, 0}, law, {}}, {"foot", 1, {l, 0}, law, {}}};
  Joint j;
  j.name = "knee", j.child = 1, j.sea = a.sea, j.uncertain = a.uncertain, j.covariance = a.covariance;
  r.joints = {j};
  out.floor = true, out.drop = s.drop;
  out.search.resize(1);
  out.execution = s.execution;
  return out;
}

}  // namespace legs

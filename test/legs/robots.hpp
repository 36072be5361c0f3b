// Robots of links that several tests play.
#pragma once

#include <string>

#include "common/actuator.hpp"
#include "landing/body/robot_file.hpp"

namespace legs {

using namespace ukemi;
using namespace ukemi::landing;

inline BodyScene shipped(const std::string& name) {
  return read_body_scene(UKEMI_DATASETS "/scenes/" + name + ".toml");
}

/// The paper's scene in the long form.
inline BodyScene long_paper(const Scene& s, const Actuator& a) {
  BodyScene out;
  const ContactLaw law{.stiffness = s.floor->stiffness,
                       .damping_normal = s.floor->damping_normal,
                       .damping_tangential = s.floor->damping_tangential};
  out.robot = by_links({s.robot, s.contacts}, law);
  Joint& j = out.robot.joints[0];
  j.sea = a.sea, j.uncertain = a.uncertain, j.covariance = a.covariance;
  out.floor = true, out.drop = s.drop;
  out.search.resize(1);
  out.execution = s.execution;
  return out;
}

}  // namespace legs

// Robots of links that several tests play.
#pragma once

#include <string>

#include "common/actuator.hpp"
#include "common/random.hpp"
#include "landing/body/by_links.hpp"
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
  out.robot = by_links(s.robot, s.contacts, law);
  out.drop_at = out.robot.links[0].com;
  Joint& j = out.robot.joints[0];
  j.sea = a.sea, j.uncertain = a.uncertain, j.covariance = a.covariance;
  out.floor = true, out.drop = s.drop;
  out.search.resize(1);
  out.execution = s.execution;
  return out;
}

/// Dry friction of every kind on every driven joint, as large as makes joints stick and slip in turn.
inline void rub(BodyScene& scene, Random& r) {
  for (Joint& j : scene.robot.joints) {
    if (!j.driven()) continue;
    SeaParameters<double>& sea = j.sea;
    sea.friction = r.uniform(0.05, 1), sea.friction_asymmetry = r.uniform(-0.4, 0.4),
    sea.spring_loss = r.uniform(0, 0.1);
    sea.breakaway = r.uniform(0, 0.6), sea.stribeck_speed = r.uniform(0.05, 1);
    if (j.kind != DriveKind::kElastic) continue;
    sea.output_friction = r.uniform(0.05, 1), sea.output_friction_asymmetry = r.uniform(-0.4, 0.4);
  }
}

}  // namespace legs

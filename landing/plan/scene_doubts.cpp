#include "landing/plan/scene_doubts.hpp"

#include <fmt/format.h>

#include "common/csv.hpp"
#include "common/degrees.hpp"
#include "common/degrees_doubt.hpp"
#include "landing/body/body_posture.hpp"
#include "landing/body/places.hpp"
#include "landing/plan/body_space.hpp"

namespace ukemi::landing {

namespace {

/// The posture in which a robot is released, and its doubts.
class ReleasedPosture {
 public:
  explicit ReleasedPosture(const BodyScene& scene) : scene_(scene), robot_(scene.robot), held_(held_posture(scene)) {}
  std::vector<std::string> doubts() {
    for (const Joint& j : robot_.joints) check_angles(j);
    for (const Stop& s : robot_.stops)
      if (s.joint >= 0) check_stop(s);
    for (const Load& l : scene_.loads)
      if (l.kind == Load::Kind::kAngle)
        add(radians_doubt(fmt::format("{}: phi_deg", l.name), {l.phi[0] * kDegrees, l.phi[1] * kDegrees}));
    if (robot_.base == Base::kRail) add(radians_doubt("robot.rail.direction_deg", robot_.rail_direction * kDegrees));
    check_pin(), check_air(), check_pads();
    return out_;
  }

 private:
  void add(std::string text) {
    if (!text.empty()) out_.push_back(std::move(text));
  }
  std::size_t index(const Joint& j) const { return std::size_t(&j - robot_.joints.data()); }
  double phi(const Joint& j) const { return j.driven() ? held_[index(j)].phi_i : j.phi; }
  /// Angle at release; of the joint of a pinned base, unless it is driven, the pitch.
  double released(const Joint& j) const {
    const bool pin = robot_.links[std::size_t(j.child)].parent < 0;
    return pin && !j.driven() ? scene_.drop.pitch : phi(j);
  }

  void check_angles(const Joint& j) {
    if (!j.driven()) return;
    const JointSearch& s = scene_.search[index(j)];
    const std::size_t before = out_.size();
    if (scene_.release || s.hold) add(radians_doubt("joint " + quoted(j.name) + " is held at", phi(j) * kDegrees));
    add(radians_doubt("search." + j.name + ".phi_deg", {s.phi[0] * kDegrees, s.phi[1] * kDegrees}));
    if (out_.size() > before || scene_.release || !s.hold || (phi(j) >= s.phi[0] && phi(j) <= s.phi[1])) return;
    add(fmt::format("joint {} is held at {:.4g} deg, and search.{}.phi_deg is {:.4g} to {:.4g}: no plan holds it there",
                    quoted(j.name), phi(j) * kDegrees, j.name, s.phi[0] * kDegrees, s.phi[1] * kDegrees));
  }
  void check_stop(const Stop& s) {
    const Joint& j = robot_.joints[std::size_t(s.joint)];
    const double phi = released(j), beyond = std::max(s.ends[0] - phi, phi - s.ends[1]);
    if (beyond > 0)
      add(fmt::format("joint {} is let go at {:.4g} deg, {:.3g} deg beyond its stop: the stop throws it back",
                      quoted(j.name), phi * kDegrees, beyond * kDegrees));
    add(radians_doubt("stop." + j.name + ".phi_deg", {s.ends[0] * kDegrees, s.ends[1] * kDegrees}));
  }
  /// One angle of the first link given twice; contacts below the floor.
  void check_pin() {
    if (robot_.base != Base::kPinned) return;
    const Joint* pin = robot_.joint_of(0);
    const double given = pin ? phi(*pin) : scene_.drop.pitch;
    const double other = pin && pin->driven() ? scene_.drop.pitch : given;  // 0: not given
    if (pin && given != scene_.drop.pitch && other != 0)
      add(fmt::format("joint {} at {:.4g} deg and drop.pitch_deg {:.4g} are one angle: the {} counts",
                      quoted(pin->name), given * kDegrees, scene_.drop.pitch * kDegrees,
                      pin->driven() ? "joint's" : "drop's"));
    const Body<double, kAny> body = body_of<kAny>(robot_);
    std::vector<double> phi_of;
    for (const Joint& j : robot_.joints) phi_of.push_back(phi(j));
    const auto pose = rest_pose(robot_, body, scene_.drop.pitch, phi_of);
    for (std::size_t i = 0; i < robot_.contacts.size(); ++i) {
      const ContactPoint& c = robot_.contacts[i];
      const double height =
          robot_.pin_height + position(body.contact[i], pose, body.bodies).y() - (c.pad ? c.pad->thickness : 0);
      if (scene_.floor && height < 0)
        add(fmt::format("contact {} is let go {:.3g} m below the floor", quoted(c.name), -height));
    }
  }
  void check_air() {
    if (!scene_.release || robot_.base == Base::kPinned || !scene_.touches()) return;
    if (const double fall = fall_time(scene_); !(scene_.release->from < fall))
      add(fmt::format("release.from {} s: the floor comes after {:.4g} s: no joint moves in the air",
                      shortest(scene_.release->from), fall));
  }
  void check_pads() {
    for (const ContactPoint& c : robot_.contacts)
      if (c.pad && c.pad->thickness > reach(robot_))
        add(fmt::format("contact {}: its pad is {:g} m thick, and the robot reaches {:.3g} m: thickness is in metres",
                        quoted(c.name), c.pad->thickness, reach(robot_)));
  }

  const BodyScene& scene_;
  const Robot& robot_;
  BodyMotion held_;
  std::vector<std::string> out_;
};

}  // namespace

std::vector<std::string> doubts(const BodyScene& scene) {
  std::vector<std::string> out = doubts(scene.robot);
  for (std::string& doubt : ReleasedPosture(scene).doubts()) out.push_back(std::move(doubt));
  return out;
}

}  // namespace ukemi::landing

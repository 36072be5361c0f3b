#include "landing/plan/design_numbers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <limits>

#include "common/actuator_constants.hpp"
#include "common/degrees.hpp"
#include "common/error.hpp"
#include "landing/body/floor_constants.hpp"
#include "landing/body/places.hpp"
#include "landing/body/robot_file.hpp"

namespace ukemi::landing {

namespace {

constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();

struct DesignNumber {
  std::string name;
  std::function<double(const BodyScene&)> get;
  std::function<void(BodyScene&, double)> set;
};

/// A number of the scene; `scale`: SI per unit of the files.
template <class Path>
DesignNumber number(const std::string& name, Path path, double scale = 1) {
  return {name, [=](const BodyScene& s) { return path(const_cast<BodyScene&>(s)) / scale; },
          [=](BodyScene& s, double x) { path(s) = x * scale; }};
}
template <class Path>
DesignNumber rating(const std::string& name, Path path) {
  return {name, [=](const BodyScene& s) { return path(const_cast<BodyScene&>(s)).value_or(kAbsent); },
          [=](BodyScene& s, double x) { path(s) = x; }};
}

void add_drive(std::vector<DesignNumber>& out, const Robot& robot, std::size_t i) {
  const Joint& joint = robot.joints[i];
  const std::string prefix = "drive." + joint.name + ".";
  const auto add = [&](const char* key, double Joint::*at, double scale = 1) {
    out.push_back(number(
        prefix + key, [=](BodyScene& s) -> double& { return s.robot.joints[i].*at; }, scale));
  };
  if (joint.driven()) {
    for (const ActuatorConstant& c : actuator_constants())
      if (joint.kind == DriveKind::kElastic || is_geared_constant(c.key))
        out.push_back(
            number(prefix + c.key, [i, at = c.at](BodyScene& s) -> double& { return s.robot.joints[i].sea.*at; }));
    out.push_back(rating(
        prefix + "speed_max", [i](BodyScene & s) -> auto& { return s.robot.joints[i].speed_max; }));
    out.push_back(rating(
        prefix + "motor_torque_max", [i](BodyScene & s) -> auto& { return s.robot.joints[i].motor_torque_max; }));
  } else if (joint.kind == DriveKind::kPassive) {
    add("stiffness", &Joint::stiffness), add("damping", &Joint::damping), add("rest_deg", &Joint::rest, kDegree);
    out.push_back(number(prefix + "friction", [i](BodyScene& s) -> double& { return s.robot.joints[i].sea.friction; }));
  }
  if (joint.kind == DriveKind::kLocked) return;
  add("parallel_stiffness", &Joint::parallel_stiffness);
  add("parallel_rest_deg", &Joint::parallel_rest, kDegree);
}

/// drive.*.KEY: a number of every driven joint that has it.
void add_all_drives(std::vector<DesignNumber>& out, const Robot& robot) {
  std::vector<std::string> keys = {"speed_max", "motor_torque_max"};
  for (const ActuatorConstant& c : actuator_constants()) keys.push_back(c.key);
  for (const std::string& key : keys) {
    std::vector<DesignNumber> all;
    for (const Joint& j : robot.joints) {
      const auto of = [&](auto& n) { return n.name == "drive." + j.name + "." + key; };
      if (const auto n = std::find_if(out.begin(), out.end(), of); j.driven() && n != out.end()) all.push_back(*n);
    }
    if (all.empty()) continue;
    out.push_back({"drive.*." + key, all.front().get, [all](BodyScene& s, double x) {
                     for (const DesignNumber& n : all) n.set(s, x);
                   }});
  }
}

/// The coordinates of a place of the robot, e.g. links[1].at.
void add_place(std::vector<DesignNumber>& out, const std::string& prefix, std::function<Place&(Robot&)> place) {
  out.push_back(number(prefix + "along", [=](BodyScene& s) -> double& { return place(s.robot).along; }));
  out.push_back(number(prefix + "across", [=](BodyScene& s) -> double& { return place(s.robot).across; }));
}

/// Length of a link from its joint to the farthest of its children's joints, its contacts and the point that counts.
double length_of(const Robot& robot, std::size_t link) {
  double out = 0;
  for (const Place& p : places(robot, int(link))) out = std::max(out, p.along);
  return out;
}
/// Scales the link along its axis: joints, contacts, the point that counts, points of pushes and loads, centre of mass
/// and inertia; the mass stays.
void set_length(BodyScene& s, std::size_t link, double length) {
  const double factor = length / length_of(s.robot, link);
  const auto stretch = [&](int owner, Place& p) {
    if (owner == int(link)) p.along *= factor;
  };
  for (Link& l : s.robot.links) stretch(l.parent, l.at);
  for (ContactPoint& c : s.robot.contacts) stretch(c.link, c.at);
  for (PushPoint& p : s.robot.pushes) stretch(p.link, p.at);
  for (Load& l : s.loads)
    if (l.kind == Load::Kind::kAcceleration) stretch(l.index, l.at);
  stretch(s.robot.peak_link, s.robot.peak);
  Link& own = s.robot.links[link];
  stretch(int(link), own.com), own.inertia_com *= factor * factor;
}

void add_link(std::vector<DesignNumber>& out, const Robot& robot, std::size_t i) {
  const std::string prefix = "robot.link." + robot.links[i].name + ".";
  if (length_of(robot, i) > 0)
    out.push_back({prefix + "length", [i](const BodyScene& s) { return length_of(s.robot, i); },
                   [i](BodyScene& s, double x) { set_length(s, i, x); }});
  if (robot.links[i].parent >= 0) add_place(out, prefix + "at.", [i](Robot& r) -> Place& { return r.links[i].at; });
  out.push_back(number(prefix + "mass", [i](BodyScene& s) -> double& { return s.robot.links[i].mass; }));
  out.push_back(number(prefix + "inertia_com", [i](BodyScene& s) -> double& { return s.robot.links[i].inertia_com; }));
  out.push_back(number(prefix + "com.along", [i](BodyScene& s) -> double& { return s.robot.links[i].com.along; }));
  out.push_back(number(prefix + "com.across", [i](BodyScene& s) -> double& { return s.robot.links[i].com.across; }));
}

/// Of [stop.JOINT] and [stop.rail].
void add_stop(std::vector<DesignNumber>& out, const Robot& robot, std::size_t i) {
  const bool rail = robot.stops[i].joint < 0;
  const std::string prefix = "stop." + stop_name(robot, robot.stops[i]) + ".";
  const auto add = [&](const char* key, auto path, double scale = 1) {
    out.push_back(number(
        prefix + key, [=](BodyScene& s) -> double& { return path(s.robot.stops[i]); }, scale));
  };
  add("stiffness", [](Stop& s) -> double& { return s.stiffness; });
  add("damping", [](Stop& s) -> double& { return s.damping; });
  add(
      rail ? "low" : "low_deg", [](Stop& s) -> double& { return s.ends[0]; }, rail ? 1 : kDegree);
  add(
      rail ? "high" : "high_deg", [](Stop& s) -> double& { return s.ends[1]; }, rail ? 1 : kDegree);
}

/// The key of files: pad.thickness for pad_thickness.
std::string file_key(const std::string& key) { return key.rfind("pad_", 0) == 0 ? "pad." + key.substr(4) : key; }
/// Constants of contacts, by their names in floor_constants; `prefix`: of the key of files.
DesignNumber contact_number(const std::string& prefix, const std::string& key, const std::string& name) {
  const bool thickness = key == "pad_thickness";
  return {prefix + file_key(key),
          [=](const BodyScene& s) {
            const std::vector<double*> all = floor_constants(const_cast<BodyScene&>(s), name);
            return all.empty() ? thickness ? 0 : kAbsent : *all.front();
          },
          [=](BodyScene& s, double value) {
            const std::vector<double*> all = floor_constants(s, name);
            if (all.empty())
              throw InputError(prefix + file_key(key) + ": there is no pad: its stiffness and damping are needed");
            for (double* const x : all) *x = value;
            for (ContactPoint& c : s.robot.contacts)
              if (thickness && c.pad && c.pad->thickness == 0) c.pad.reset();
          }};
}

std::vector<DesignNumber> design_of(const BodyScene& scene) {
  std::vector<DesignNumber> out;
  const Robot& robot = scene.robot;
  for (std::size_t i = 0; i < robot.joints.size(); ++i) add_drive(out, robot, i);
  add_all_drives(out, robot);
  for (std::size_t i = 0; i < robot.links.size(); ++i) add_link(out, robot, i);
  for (std::size_t i = 0; i < robot.stops.size(); ++i) add_stop(out, robot, i);
  for (const std::string key : kContactKeys) {
    for (const ContactPoint& c : robot.contacts)
      out.push_back(contact_number("robot.contact." + c.name + ".", key, c.name + "." + key));
    out.push_back(contact_number("robot.contact.*.", key, "*." + key));
    if (key.rfind("pad_", 0) != 0) out.push_back(contact_number("floor.", key, key));
  }
  for (std::size_t i = 0; i < scene.loads.size(); ++i)
    out.push_back(
        number("load." + scene.loads[i].name + ".rating", [i](BodyScene& s) -> double& { return s.loads[i].rating; }));
  for (std::size_t i = 0; i < robot.contacts.size(); ++i)
    add_place(out, "robot.contact." + robot.contacts[i].name + ".at.",
              [i](Robot& r) -> Place& { return r.contacts[i].at; });
  out.push_back(number("robot.gravity", [](BodyScene& s) -> double& { return s.robot.gravity; }));
  if (robot.base == Base::kPinned && !robot.contacts.empty())
    out.push_back(number("robot.pin_height", [](BodyScene& s) -> double& { return s.robot.pin_height; }));
  if (robot.base == Base::kRail) {
    out.push_back(number(
        "robot.rail.direction_deg", [](BodyScene& s) -> double& { return s.robot.rail_direction; }, kDegree));
    out.push_back(number("robot.rail.viscous", [](BodyScene& s) -> double& { return s.robot.rail_viscous; }));
    out.push_back(number("robot.rail.friction", [](BodyScene& s) -> double& { return s.robot.rail_friction; }));
    out.push_back(
        number("robot.rail.load_friction", [](BodyScene& s) -> double& { return s.robot.rail_load_friction; }));
  }
  out.push_back(number(
      "floor.slope_deg", [](BodyScene& s) -> double& { return s.slope; }, kDegree));
  if (robot.base != Base::kPinned)
    out.push_back(number("drop.height", [](BodyScene& s) -> double& { return s.drop.height; }));
  if (robot.base == Base::kFree)
    out.push_back(number("drop.forward_speed", [](BodyScene& s) -> double& { return s.drop.forward_speed; }));
  out.push_back(number("detection.delay", [](BodyScene& s) -> double& { return s.detection_delay; }));
  out.push_back(number(
      "drop.pitch_deg", [](BodyScene& s) -> double& { return s.drop.pitch; }, kDegree));
  return out;
}

DesignNumber find_number(const BodyScene& scene, const std::string& name) {
  std::vector<std::string> names;
  for (DesignNumber& n : design_of(scene)) {
    if (n.name == name) return n;
    names.push_back(n.name);
  }
  throw InputError(quoted(name) + ": no number of this robot, its floor or its drop" + hint(name, names));
}

}  // namespace

bool is_rating(const std::string& name) { return name.ends_with(".speed_max") || name.ends_with(".motor_torque_max"); }

std::vector<std::string> design_names(const BodyScene& scene) {
  std::vector<std::string> out;
  for (const DesignNumber& n : design_of(scene)) out.push_back(n.name);
  return out;
}

std::function<void(BodyScene&, double)> design_setter(const BodyScene& scene, const std::string& name) {
  return find_number(scene, name).set;
}

std::function<double(const BodyScene&)> design_getter(const BodyScene& scene, const std::string& name) {
  return find_number(scene, name).get;
}

double design_number(const BodyScene& scene, const std::string& name) { return design_getter(scene, name)(scene); }

void set_design_number(BodyScene& scene, const std::string& name, double value) {
  find_number(scene, name).set(scene, value);
  try {
    scene.validate();
  } catch (const InputError& e) {
    throw InputError(fmt::format("{} = {:g}: {}", name, value, e.what()));
  }
}

}  // namespace ukemi::landing

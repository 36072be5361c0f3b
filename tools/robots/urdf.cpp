// Robots in URDF, parsed by liburdfdom.
#include "common/error.hpp"
#include "tools/robots/spatial_robot.hpp"

#ifdef UKEMI_WITH_URDF

#include <console_bridge/console.h>
#include <fmt/format.h>
#include <urdf_parser/urdf_parser.h>

#include <set>

#include "common/files.hpp"

namespace ukemi::tools {

namespace {

/// Collects the parser's messages, which would go to stderr, during its lifetime.
class UrdfMessages : public console_bridge::OutputHandler {
 public:
  UrdfMessages() { console_bridge::useOutputHandler(this); }
  ~UrdfMessages() override { console_bridge::restorePreviousOutputHandler(); }
  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level == console_bridge::CONSOLE_BRIDGE_LOG_ERROR) errors.push_back(text);
    if (level == console_bridge::CONSOLE_BRIDGE_LOG_WARN) warnings.push_back(text);
  }
  std::vector<std::string> errors, warnings;
};

Eigen::Vector3d vector_of(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }
Eigen::Isometry3d pose_of(const urdf::Pose& p) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  double x, y, z, w;
  p.rotation.getQuaternion(x, y, z, w);
  out.linear() = Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix();
  out.translation() = vector_of(p.position);
  return out;
}

SpatialInertia inertia_of(const urdf::Link& link) {
  if (!link.inertial) return {};
  const urdf::Inertial& i = *link.inertial;
  SpatialInertia out{i.mass, Eigen::Vector3d::Zero(), Eigen::Matrix3d::Zero()};
  out.tensor << i.ixx, i.ixy, i.ixz, i.ixy, i.iyy, i.iyz, i.ixz, i.iyz, i.izz;
  return in_frame(out, pose_of(i.origin));
}

const char* type_of(const urdf::Joint& joint) {
  switch (joint.type) {
    case urdf::Joint::REVOLUTE:
      return "revolute";
    case urdf::Joint::CONTINUOUS:
      return "continuous";
    case urdf::Joint::PRISMATIC:
      return "prismatic";
    case urdf::Joint::FLOATING:
      return "floating";
    case urdf::Joint::PLANAR:
      return "planar";
    case urdf::Joint::FIXED:
      return "fixed";
    default:
      return "unknown";
  }
}

SpatialJoint joint_of(const urdf::Joint& from) {
  using enum SpatialJoint::Motion;
  SpatialJoint out;
  out.name = from.name, out.type = type_of(from);
  const bool turns = from.type == urdf::Joint::REVOLUTE || from.type == urdf::Joint::CONTINUOUS;
  out.motion = turns                                ? kTurns
               : from.type == urdf::Joint::FIXED    ? kFixed
               : from.type == urdf::Joint::FLOATING ? kFloats
                                                    : kOther;
  out.axis = vector_of(from.axis);
  if (out.axis.norm() > 0) out.axis.normalize();
  if (from.limits) {
    if (from.type == urdf::Joint::REVOLUTE) out.lower = from.limits->lower, out.upper = from.limits->upper;
    if (from.type == urdf::Joint::PRISMATIC) out.travel = {from.limits->lower, from.limits->upper};
    if (from.limits->effort > 0) out.effort = from.limits->effort;
    if (from.limits->velocity > 0) out.speed = from.limits->velocity;
  }
  if (from.dynamics) out.damping = from.dynamics->damping, out.friction = from.dynamics->friction;
  if (from.mimic) out.follows = from.mimic->joint_name;
  return out;
}

/// Depth first, children in the order of the parser: that of their joints' names.
void add_link(const urdf::Link& link, int parent, SpatialRobot& out, std::set<std::string>& seen) {
  if (!seen.insert(link.name).second)
    throw InputError({out.file}, "link " + quoted(link.name) + ": two joints have it as their child: a tree is needed");
  SpatialBody body;
  body.name = link.name, body.parent = parent, body.inertia = inertia_of(link);
  if (parent >= 0) {
    body.in_parent = pose_of(link.parent_joint->parent_to_joint_origin_transform);
    body.joint = joint_of(*link.parent_joint);
  }
  const int index = int(out.bodies.size());
  out.bodies.push_back(std::move(body));
  out.points.push_back({link.name, "link", index, Eigen::Vector3d::Zero()});
  for (const auto& child : link.child_links) add_link(*child, index, out, seen);
}

/// Whether an error concerns shapes or colours only, after which the parser continues without them.
bool is_visual_error(const std::string& text) {
  for (const char* part : {"isual", "ollision", "eometry", "aterial", "olor", "esh", "exture"})
    if (text.find(part) != std::string::npos) return true;
  return false;
}
std::string joined(const std::vector<std::string>& texts) {
  std::string out;
  for (std::size_t i = 0; i < texts.size() && i < 3; ++i) out += (i ? "; " : "") + texts[i];
  return out;
}

}  // namespace

SpatialRobot read_urdf(const std::string& path) {
  SpatialRobot out;
  out.file = path, out.format = "URDF", out.no_drive = "URDF knows no drive";
  UrdfMessages messages;
  urdf::ModelInterfaceSharedPtr model;
  try {
    model = urdf::parseURDF(read_text_file(path, kLargestFile));
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& e) {
    messages.errors.push_back(e.what());
  }
  std::erase_if(messages.errors, [&](const std::string& text) { return model && is_visual_error(text); });
  if (!model || !model->getRoot() || !messages.errors.empty())
    throw InputError(
        {path}, messages.errors.empty() ? "liburdfdom finds no robot in it" : "liburdfdom: " + joined(messages.errors));
  out.warnings = messages.warnings;
  std::set<std::string> seen;
  add_link(*model->getRoot(), -1, out, seen);
  std::size_t visuals = 0, collisions = 0;
  for (const auto& [name, link] : model->links_) {
    if (!seen.count(name))
      throw InputError({path}, "link " + quoted(name) + ": it hangs in a circle, not on the root " +
                                   quoted(model->getRoot()->name) + ": a tree is needed");
    visuals += link->visual_array.size(), collisions += link->collision_array.size();
  }
  out.left_out = {fmt::format("{} visuals", visuals), fmt::format("{} collisions", collisions),
                  "transmissions, sensors and extensions, if any"};
  return out;
}

}  // namespace ukemi::tools

#else

namespace ukemi::tools {

SpatialRobot read_urdf(const std::string& path) {
  throw InputError({path},
                   "this program was built without liburdfdom: for URDF install liburdfdom-dev and build again");
}

}  // namespace ukemi::tools

#endif

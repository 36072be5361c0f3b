// Writes robot.toml of a projection.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <sstream>

#include "common/csv.hpp"
#include "common/degrees.hpp"
#include "common/toml.hpp"
#include "tools/robots/projection.hpp"

namespace ukemi::tools {

namespace {

std::string commented_out(const std::string& text) {
  std::istringstream in(text);
  std::string out;
  for (std::string line; std::getline(in, line);) out += "# " + line + "\n";
  return out;
}
std::string place_toml(const landing::Place& p) {
  return fmt::format("[{}, {}]", shortest(p.along), shortest(p.across));
}
std::string text_toml(const std::string& s) { return "\"" + toml_text(s) + "\""; }

std::string header_toml(const landing::Robot& robot, const std::string& format, bool gravity_known) {
  std::string out = fmt::format("[robot]\ngravity = {}{}\n", shortest(robot.gravity),
                                gravity_known ? "   # m/s^2" : "   # m/s^2: " + format + " holds none, check it");
  if (robot.base == landing::Base::kRail)
    out += fmt::format("base = \"rail\"\nrail = {{ direction_deg = {} }}   # upright\n",
                       shortest(std::round(robot.rail_direction * kDegrees)));
  if (robot.base == landing::Base::kPinned)
    out += fmt::format("base = \"pinned\"\npin_height = {}   # m\n", shortest(robot.pin_height));
  return out;
}

/// The description's convention of the joint's angle, for messages to the robot.
std::string angle_convention_toml(const landing::Joint& joint) {
  return fmt::format("q = {{ name = {}, sign = {}, zero_deg = {} }}   # its q = zero + sign phi, in messages\n",
                     text_toml(joint.q_name), shortest(joint.q_sign), shortest(joint.q_zero * kDegrees));
}

std::string links_toml(const landing::Robot& robot) {
  std::string out;
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const landing::Link& l = robot.links[i];
    out += fmt::format("\n[[robot.link]]\nname = {}\n", text_toml(l.name));
    if (l.parent >= 0)
      out += fmt::format("parent = {}\nat = {}   # m: along, across\n",
                         text_toml(robot.links[std::size_t(l.parent)].name), place_toml(l.at));
    if (const landing::Joint* joint = robot.joint_of(int(i)))
      out += fmt::format("joint = {}\n{}", text_toml(joint->name), angle_convention_toml(*joint));
    out += fmt::format("mass = {}   # kg\ninertia_com = {}   # kg m^2\ncom = {}   # m\n", shortest(l.mass),
                       shortest(l.inertia_com), place_toml(l.com));
  }
  return out;
}

std::string contacts_toml(const landing::Robot& robot) {
  std::string out;
  for (const landing::ContactPoint& c : robot.contacts)
    out += fmt::format("\n[[robot.contact]]\nname = {}\nlink = {}\nat = {}   # m\n", text_toml(c.name),
                       text_toml(robot.links[std::size_t(c.link)].name), place_toml(c.at));
  return out;
}

/// A joint without an actuator file is passive, with the description's constants; a geared drive is prepared as a
/// comment, with '?' for every unknown constant.
std::string drive_toml(const landing::Joint& joint, const SpatialJoint& from, const std::string& file,
                       const std::string& no_drive) {
  std::string out = "\n";
  if (from.lower && from.upper)
    out += fmt::format("# limits; in a scene: [search] {} = {{ phi_deg = [{}, {}] }}\n", joint.name,
                       shortest(*from.lower * kDegrees), shortest(*from.upper * kDegrees));
  if (!file.empty()) return out + fmt::format("[drive.{}]\nfile = {}\n", joint.name, text_toml(file));
  const auto known = [](const std::optional<double>& value) { return value ? shortest(*value) : std::string("?"); };
  const auto above_zero = [](double value) { return value > 0 ? std::optional(value) : std::nullopt; };
  out += fmt::format("# TO FILL IN: {}, so this joint swings freely. A motor that turns with it:\n", no_drive);
  out += "# kind = \"geared\"\n# k_p = ?   # Nm/rad\n# k_d = ?   # Nm/(rad/s)\n";
  out += fmt::format("# i_motor = {}   # kg m^2 at the joint, armature\n", known(above_zero(from.armature)));
  out += fmt::format("# tau_max = {}   # Nm\n# speed_max = {}   # rad/s\n", known(from.effort), known(from.speed));
  if (from.friction > 0) out += fmt::format("# friction = {}   # Nm\n", shortest(from.friction));
  if (from.damping > 0) out += fmt::format("# viscous_friction = {}   # Nm/(rad/s)\n", shortest(from.damping));
  out += fmt::format("[drive.{}]\nkind = \"passive\"\n", joint.name);
  if (joint.stiffness > 0)
    out += fmt::format("stiffness = {}   # Nm/rad\nrest_deg = {}\n", shortest(joint.stiffness),
                       shortest(joint.rest * kDegrees));
  if (joint.sea.friction > 0) out += fmt::format("friction = {}   # Nm\n", shortest(joint.sea.friction));
  return out + fmt::format("damping = {}   # Nm/(rad/s)\n", shortest(joint.damping));
}

/// Relative to the folder of robot.toml; absolute where that is not possible.
std::string relative_path(const std::string& file, const std::string& folder) {
  namespace fs = std::filesystem;
  if (file.empty()) return file;
  std::error_code ec;
  const fs::path out = fs::proximate(fs::absolute(file), fs::absolute(folder), ec);
  return ec || out.empty() ? fs::absolute(file).string() : out.string();
}

}  // namespace

std::string robot_toml(const Projection& p, const SpatialRobot& from, const std::string& folder,
                       const std::string& comments) {
  std::string out = commented_out(comments) + "#\n";
  for (const Note& n : p.notes)
    out += commented_out(fmt::format("{}{}{}: {}", n.what, n.name.empty() ? "" : " ", n.name, n.text));
  out += header_toml(p.robot, from.format, from.gravity.has_value()) + links_toml(p.robot) + contacts_toml(p.robot);
  for (std::size_t i = 0; i < p.robot.joints.size(); ++i)
    out += drive_toml(p.robot.joints[i], p.joints[i], relative_path(p.drive_files[i], folder), from.no_drive);
  return out;
}

}  // namespace ukemi::tools

#include "tools/report/body_scene_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "common/csv.hpp"
#include "common/degrees.hpp"
#include "common/error.hpp"
#include "common/toml.hpp"
#include "common/toml_edit.hpp"
#include "common/uncertainty_file.hpp"
#include "landing/body/floor_constants.hpp"
#include "landing/body/load.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

namespace fs = std::filesystem;
using Path = TomlEdit::Place;

/// Whether a constant has a say in a law.
bool acts(const std::string& key, const ContactLaw& law) {
  if (key == "damping_normal") return !law.hunt_crossley;
  if (key == "exponent" || key == "dissipation") return law.hunt_crossley;
  if (key == "friction") return std::isfinite(law.friction);
  if (key == "stiffness_tangential") return std::isfinite(law.friction) || law.stiffness_tangential > 0;
  return true;
}

bool gives(const ContactPoint& c, const std::string& key) {
  return std::find(c.own.begin(), c.own.end(), key) != c.own.end();
}
/// What [floor] says of a key: the value of the first contact that has none of its own; null: none does.
const ContactPoint* follower(const Robot& robot, const std::string& key) {
  for (const ContactPoint& c : robot.contacts)
    if (!gives(c, key)) return &c;
  return nullptr;
}

void write_law(const ContactLaw& law, TomlEdit& file, const Path& table) {
  if (law.hunt_crossley)
    file.set(table, "law", std::string("hunt_crossley"));
  else
    file.remove(table, "law");
}

void write_floor(const Robot& robot, const std::string& source, TomlEdit& file) {
  const Path table = {"floor"};
  for (auto constant = kLawConstants.rbegin(); constant != kLawConstants.rend(); ++constant) {
    const ContactPoint* c = follower(robot, constant->key);
    if (!c) continue;
    if (acts(constant->key, c->law))
      file.set(table, constant->key, c->law.*constant->at);
    else
      file.remove(table, constant->key);
  }
  write_law(robot.contacts.front().law, file, table);
  file.set(table, "source", source);
}

/// True where the table of a contact changes.
bool write_contact(const Robot& robot, std::size_t i, TomlEdit& file) {
  const ContactPoint& c = robot.contacts[i];
  const std::string before = file.text();
  const Path table = {"robot", "contact", std::to_string(i)}, pad = {"robot", "contact", std::to_string(i), "pad"};
  for (const LawConstant& constant : kLawConstants) {
    const std::string key = constant.key;
    const ContactPoint* floor = follower(robot, key);
    const bool other = !floor || floor->law.*constant.at != c.law.*constant.at;
    if (!acts(key, c.law))
      file.remove(table, key);
    else if (gives(c, key) || other)
      file.set(table, key, c.law.*constant.at);
  }
  file.remove(table, "law");  // [floor] has it
  if (!c.pad) {
    file.remove(table, "pad");
  } else if (!file.has(table, "pad")) {
    file.set_raw(table, "pad",
                 fmt::format("{{ thickness = {}, stiffness = {}, damping = {} }}", shortest(c.pad->thickness),
                             shortest(c.pad->stiffness), shortest(c.pad->damping)));
  } else {
    file.set(pad, "thickness", c.pad->thickness), file.set(pad, "stiffness", c.pad->stiffness);
    if (c.pad->damping != 0 || file.has(pad, "damping")) file.set(pad, "damping", c.pad->damping);
  }
  return file.text() != before;
}

}  // namespace

std::string from_folder(const std::string& path, const std::string& folder) {
  return fs::relative(fs::absolute(path), fs::absolute(folder)).generic_string();
}

void write_own_law(const ContactPoint& contact, TomlEdit& file, const TomlEdit::Place& table) {
  for (const LawConstant& constant : kLawConstants)
    if (acts(constant.key, contact.law)) file.set(table, constant.key, contact.law.*constant.at);
  write_law(contact.law, file, table);
}

void move_drives(const Robot& robot, const std::string& path, const std::string& folder, TomlEdit& file) {
  for (const Joint& j : robot.joints)
    if (const std::string drive = file.text_at({"drive", j.name}, "file"); !drive.empty())
      file.set({"drive", j.name}, "file", from_folder((fs::path(path).parent_path() / drive).string(), folder));
}

std::string drive_tables(const BodyScene& scene, const std::vector<GivenDrive>& drives, const TomlEdit& file,
                         const TomlEdit& robot, const std::string& folder) {
  std::string out;
  for (const GivenDrive& g : drives) {
    const auto takes = [&](const Joint& j) {
      const bool own = file.has({"drive"}, j.name) || robot.has({"drive"}, j.name);
      return j.driven() && !own && (g.joint.empty() || g.joint == j.name);
    };
    const auto joint = std::find_if(scene.robot.joints.begin(), scene.robot.joints.end(), takes);
    if (joint == scene.robot.joints.end())
      throw InputError(g.option + ": " + ukemi::quoted(g.file) +
                       ": the joint has a drive in its file: what is kept with its scene is changed there");
    out += fmt::format("\n[drive.{}]\nfile = \"{}\"\n", joint->name, toml_text(from_folder(g.file, folder)));
  }
  return out;
}

namespace {

/// Limits that are no loads of the file, nor stops of its joints.
std::string limits_beside(const BodyScene& scene, const TomlEdit& file) {
  std::vector<std::string> there;
  for (std::string name; !(name = file.text_at({"load", std::to_string(there.size())}, "name")).empty();)
    there.push_back(name);
  std::string out;
  for (const Load& l : scene.loads) {
    if (l.kind == Load::Kind::kAngle || std::find(there.begin(), there.end(), l.name) != there.end()) continue;
    const char* const on = l.kind == Load::Kind::kTouch ? "contact" : "joint";
    out += fmt::format("\n[[load]]\nname = \"{}\"\nkind = \"{}\"\n{} = \"{}\"\nrating = {}\nlimit = true\n",
                       toml_text(l.name), name(l.kind), on, toml_text(place_of(l, scene.robot)), shortest(l.rating));
  }
  return out;
}

std::string tables_behind(const BodyScene& scene) {
  std::string out;
  if (scene.uncertainty) {
    std::string names;
    for (const std::string& name : scene.uncertainty->order) names += (names.empty() ? "\"" : ", \"") + name + "\"";
    out += "\n[uncertainty]\norder = [" + names + "]\n" + covariance_lines(scene.uncertainty->covariance);
  }
  return out + verdict_table(scene.verdicts);
}

}  // namespace

std::map<std::string, std::string> scene_files(const std::string& path, const BodyScene& scene,
                                               const std::string& comments, const std::string& folder,
                                               const std::vector<GivenDrive>& drives) {
  std::map<std::string, std::string> out;
  TomlEdit file(path);
  file.remove_table("uncertainty"), file.remove_table("verdict");
  const bool apart = !scene.robot_file.empty();
  const std::string before = file.text();
  write_floor(scene.robot, scene.source, file);
  bool changed = !apart && file.text() != before;  // the robot's file
  const char* pitch = file.has({"drop"}, "pitch") ? "pitch" : "pitch_deg";
  const double unit = pitch == std::string("pitch") ? 1 : kDegrees;
  file.set({"drop"}, pitch, scene.drop.pitch * unit);
  move_drives(scene.robot, path, folder, file);
  TomlEdit other = apart ? TomlEdit(scene.robot_file) : file;
  const std::string given = drive_tables(scene, drives, file, other, folder);
  for (std::size_t i = 0; i < scene.robot.contacts.size(); ++i)
    changed = write_contact(scene.robot, i, other) || changed;
  if (changed) other.remove_table("identified");  // of other constants
  CsvWriter head;
  head.comment(comments);
  if (!apart) {
    file = other;
  } else if (changed) {
    move_drives(scene.robot, scene.robot_file, folder, other);
    out["robot.toml"] = head.text() + other.text();
    file.set({}, "robot", std::string("robot.toml"));
  } else {
    file.set({}, "robot", from_folder(scene.robot_file, folder));
  }
  file.append(given + limits_beside(scene, file) + tables_behind(scene));
  out["scene.toml"] = head.text() + file.text();
  return out;
}

}  // namespace ukemi::tools

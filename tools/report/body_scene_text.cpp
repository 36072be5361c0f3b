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

/// Whether a law uses a constant.
bool is_active(const std::string& key, const ContactLaw& law) {
  if (key == "damping_normal") return !law.hunt_crossley;
  if (key == "exponent" || key == "dissipation") return law.hunt_crossley;
  if (key == "friction") return std::isfinite(law.friction);
  if (key == "stiffness_tangential") return std::isfinite(law.friction) || law.stiffness_tangential > 0;
  return true;
}

bool has_own(const ContactPoint& c, const std::string& key) {
  return std::find(c.own_keys.begin(), c.own_keys.end(), key) != c.own_keys.end();
}
/// The first contact without an own value of a key, which [floor] gives; null: there is none.
const ContactPoint* first_without_own(const Robot& robot, const std::string& key) {
  for (const ContactPoint& c : robot.contacts)
    if (!has_own(c, key)) return &c;
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
    const ContactPoint* c = first_without_own(robot, constant->key);
    if (!c) continue;
    if (is_active(constant->key, c->law))
      file.set(table, constant->key, c->law.*constant->at);
    else
      file.remove(table, constant->key);
  }
  write_law(robot.contacts.front().law, file, table);
  file.set(table, "source", source);
}

/// Writes the table of a contact; returns whether it changed.
bool write_contact(const Robot& robot, std::size_t i, TomlEdit& file) {
  const ContactPoint& c = robot.contacts[i];
  const std::string before = file.text();
  const Path table = {"robot", "contact", std::to_string(i)}, pad = {"robot", "contact", std::to_string(i), "pad"};
  for (const LawConstant& constant : kLawConstants) {
    const std::string key = constant.key;
    const ContactPoint* floor = first_without_own(robot, key);
    const bool other = !floor || floor->law.*constant.at != c.law.*constant.at;
    if (!is_active(key, c.law))
      file.remove(table, key);
    else if (has_own(c, key) || other)
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

/// [[load]] tables of limits that are neither loads in the file nor joint stops.
std::string added_limits(const BodyScene& scene, const TomlEdit& file) {
  std::vector<std::string> in_file;
  for (std::string name; !(name = file.text_at({"load", std::to_string(in_file.size())}, "name")).empty();)
    in_file.push_back(name);
  std::string out;
  for (const Load& l : scene.loads) {
    if (l.kind == Load::Kind::kAngle || std::find(in_file.begin(), in_file.end(), l.name) != in_file.end()) continue;
    const char* const on = l.kind == Load::Kind::kTouch ? "contact" : "joint";
    out += fmt::format("\n[[load]]\nname = \"{}\"\nkind = \"{}\"\n{} = \"{}\"\nrating = {}\nlimit = true\n",
                       toml_text(l.name), name(l.kind), on, toml_text(place_of(l, scene.robot)), shortest(l.rating));
  }
  return out;
}

std::string trailing_tables(const BodyScene& scene) {
  std::string out;
  if (scene.uncertainty) {
    std::string names;
    for (const std::string& name : scene.uncertainty->order) names += (names.empty() ? "\"" : ", \"") + name + "\"";
    out += "\n[uncertainty]\norder = [" + names + "]\n" + covariance_lines(scene.uncertainty->covariance);
  }
  return out + verdict_table(scene.verdicts);
}

}  // namespace

std::string relative_to(const std::string& path, const std::string& folder) {
  return fs::relative(fs::absolute(path), fs::absolute(folder)).generic_string();
}

void write_contact_law(const ContactPoint& contact, TomlEdit& file, const TomlEdit::Place& table) {
  for (const LawConstant& constant : kLawConstants)
    if (is_active(constant.key, contact.law)) file.set(table, constant.key, contact.law.*constant.at);
  write_law(contact.law, file, table);
}

void rebase_drives(const Robot& robot, const std::string& path, const std::string& folder, TomlEdit& file) {
  for (const Joint& j : robot.joints)
    if (const std::string drive = file.text_at({"drive", j.name}, "file"); !drive.empty())
      file.set({"drive", j.name}, "file", relative_to((fs::path(path).parent_path() / drive).string(), folder));
}

std::string drive_tables(const BodyScene& scene, const std::vector<GivenDrive>& drives, const TomlEdit& file,
                         const TomlEdit& robot, const std::string& folder) {
  std::string out;
  for (const GivenDrive& g : drives) {
    const auto accepts = [&](const Joint& j) {
      const bool own = file.has({"drive"}, j.name) || robot.has({"drive"}, j.name);
      return j.driven() && !own && (g.joint.empty() || g.joint == j.name);
    };
    const auto joint = std::find_if(scene.robot.joints.begin(), scene.robot.joints.end(), accepts);
    if (joint == scene.robot.joints.end())
      throw InputError(g.option + ": " + ukemi::quoted(g.file) +
                       ": the joint has a drive in its file: what is kept with its scene is changed there");
    out += fmt::format("\n[drive.{}]\nfile = \"{}\"\n", joint->name, toml_text(relative_to(g.file, folder)));
  }
  return out;
}

std::map<std::string, std::string> scene_files(const std::string& path, const BodyScene& scene,
                                               const std::string& comments, const std::string& folder,
                                               const std::vector<GivenDrive>& drives) {
  std::map<std::string, std::string> out;
  TomlEdit file(path);
  file.remove_table("uncertainty"), file.remove_table("verdict");
  const bool separate = !scene.robot_file.empty();
  const std::string before = file.text();
  write_floor(scene.robot, scene.source, file);
  bool changed = !separate && file.text() != before;  // the robot's file
  const char* pitch = file.has({"drop"}, "pitch") ? "pitch" : "pitch_deg";
  const double unit = pitch == std::string("pitch") ? 1 : kDegrees;
  file.set({"drop"}, pitch, scene.drop.pitch * unit);
  rebase_drives(scene.robot, path, folder, file);
  TomlEdit robot_file = separate ? TomlEdit(scene.robot_file) : file;
  const std::string given = drive_tables(scene, drives, file, robot_file, folder);
  for (std::size_t i = 0; i < scene.robot.contacts.size(); ++i)
    changed = write_contact(scene.robot, i, robot_file) || changed;
  if (changed) robot_file.remove_table("identified");  // it is of the former constants
  CsvWriter head;
  head.comment(comments);
  if (!separate) {
    file = robot_file;
  } else if (changed) {
    rebase_drives(scene.robot, scene.robot_file, folder, robot_file);
    out["robot.toml"] = head.text() + robot_file.text();
    file.set({}, "robot", std::string("robot.toml"));
  } else {
    file.set({}, "robot", relative_to(scene.robot_file, folder));
  }
  file.append(given + added_limits(scene, file) + trailing_tables(scene));
  out["scene.toml"] = head.text() + file.text();
  return out;
}

}  // namespace ukemi::tools

#include "tools/report/scene_edit.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "common/csv.hpp"
#include "common/error.hpp"
#include "landing/body/places.hpp"
#include "landing/plan/design_numbers.hpp"
#include "tools/program/arguments.hpp"
#include "tools/report/body_scene_text.hpp"
#include "tools/report/robot_edit.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

using Path = TomlEdit::Place;

/// Adds a table to the file unless it has it.
void make_table(TomlEdit& file, const Path& table) {
  Path above = table;
  above.pop_back();
  if (!file.has(above, table.back())) file.append(fmt::format("\n[{}]\n", fmt::join(table, ".")));
}

std::string range_text(const std::string& name, const std::string& text) {
  const NumberRange range = number_range(name, text, false);
  return fmt::format("[{}, {}]", shortest(range.lower), shortest(range.upper));
}

}  // namespace

SceneEdit::SceneEdit(const std::string& path, const BodyScene& scene) : scene_(scene), file_(path) {
  if (!scene.robot_file.empty()) robot_.emplace(scene.robot_file), robot_before_ = robot_->text();
}

void SceneEdit::set(const std::string& text) {
  const Assignment a = assignment("--set", text, "KEY=VALUE");
  if (!set_.insert(a.name).second) throw InputError(fmt::format("--set: {}: given twice", a.name));
  if (a.name == "search.duration") {
    const std::string range = range_text(a.name, a.value);
    make_table(file_, {"search"});
    return file_.set_raw({"search"}, "duration", range);
  }
  if (a.name.starts_with("search.") || (a.name.starts_with("joint.") && a.name.ends_with(".phi_deg")))
    return set_joint_value(a.name, a.value);
  if (a.name.starts_with("stop.") && a.name.ends_with(".phi_deg")) return set_stop(a.name, a.value);
  const double value = to_number(a.name, a.value);
  const bool length = a.name.starts_with("robot.link.") && a.name.ends_with(".length");
  if (length && !(value > 0)) throw InputError(fmt::format("{}: {:g}: above 0 is needed", a.name, value));
  const BodyScene before = scene_;
  design_setter(scene_, a.name)(scene_, value);  // throws for an unknown name
  if (length)
    write_lengths(before);
  else
    set_number(a.name, value);
}

/// search.JOINT.phi_deg, search.JOINT.hold_deg, joint.JOINT.phi_deg.
void SceneEdit::set_joint_value(const std::string& name, const std::string& value) {
  const std::vector<std::string> parts = split_name(name);
  std::vector<std::string> known;
  const std::optional<std::size_t> only = sole_driven_joint(scene_.robot);
  for (const Joint& j : scene_.robot.joints)
    if (j.driven())
      for (const char* key : {"phi_deg", "hold_deg"})
        if (parts[0] == "search" || key == std::string("phi_deg")) known.push_back(parts[0] + "." + j.name + "." + key);
  if (parts[0] == "search") known.push_back("search.duration");
  if (std::find(known.begin(), known.end(), name) == known.end()) throw InputError(one_of(name, known));
  const bool is_hold = parts[2] == "hold_deg";
  const std::string text = is_hold ? shortest(to_number(name, value)) : range_text(name, value);
  // The only driven joint may have its keys in [search] itself.
  Path table = {parts[0]};
  const auto has_key = [&](const char* key) { return file_.has(table, key); };
  const bool short_form = only && (has_key("phi") || has_key("phi_deg") || has_key("hold") || has_key("hold_deg"));
  make_table(file_, table);
  if (!short_form) table.push_back(parts[1]), make_table(file_, table);
  file_.remove(table, is_hold ? "hold" : "phi"), file_.set_raw(table, parts[2], text);
}

/// stop.JOINT.phi_deg.
void SceneEdit::set_stop(const std::string& name, const std::string& value) {
  const NumberRange range = number_range(name, value, false);
  const std::string stop = name.substr(0, name.rfind('.'));
  const std::vector<std::string> known = design_names(scene_);
  if (std::find(known.begin(), known.end(), stop + ".low_deg") == known.end())
    throw InputError(fmt::format("{}: the robot's file has no [{}] with a stiffness", name, stop));
  for (const auto& [key, degrees] : {std::pair(".low_deg", range.lower), {".high_deg", range.upper}}) {
    design_setter(scene_, stop + key)(scene_, degrees);
    set_number(stop + key, degrees);
  }
}

void SceneEdit::set_number(const std::string& name, double value) {
  const std::vector<std::string> parts = split_name(name);
  const Path table(parts.begin(), parts.end() - 1);
  const bool of_robot = parts[0] == "robot", of_contact = of_robot && parts[1] == "contact";
  if (parts[1] == "*" || (of_contact && parts[2] == "*")) {
    const std::size_t star = of_contact ? 2 : 1;
    std::vector<std::string> names;
    for (const ContactPoint& c : of_contact ? scene_.robot.contacts : std::vector<ContactPoint>{})
      if (parts[3] != "pad" || c.pad) names.push_back(c.name);
    for (const Joint& j : of_contact ? std::vector<Joint>{} : scene_.robot.joints)
      if (j.driven() && (j.kind == DriveKind::kElastic || is_geared_constant(parts[2]) || parts[2].ends_with("_max")))
        names.push_back(j.name);
    for (const std::string& one : names) {
      std::vector<std::string> expanded = parts;
      expanded[star] = one;
      set_number(fmt::format("{}", fmt::join(expanded, ".")), value);
    }
    return;
  }
  if (of_contact && parts[3] == "pad" && value == 0 && parts[4] == "thickness")
    return robot_file().remove({"robot", "contact", index_of(robot_file(), {"robot", "contact"}, parts[2])}, "pad");
  if (parts[0] == "drive") {
    const bool in_robot = robot_file().has({"drive"}, parts[1]);
    if (!in_robot && !file_.has({"drive"}, parts[1]))
      throw InputError(name + ": its drive comes from --actuator: it is changed in that file");
    if (const std::string path = (in_robot ? robot_file() : file_).text_at({"drive", parts[1]}, "file"); !path.empty())
      throw InputError(
          fmt::format("{}: its drive stands in {}: change a copy of that, and give it by --actuator {}=COPY", name,
                      quoted(path), parts[1]));
    return tools::set_number(in_robot ? robot_file() : file_, name, value);
  }
  if (of_robot || parts[0] == "stop") return tools::set_number(robot_file(), name, value);
  if (parts[0] == "load") return file_.set({"load", index_of(file_, {"load"}, parts[1])}, parts[2], value);
  if (parts[0] == "detection")
    make_table(file_, table);
  else if (!file_.has({}, parts[0]))
    throw InputError(fmt::format("{}: the file has no [{}]", name, parts[0]));
  set_key(file_, table, parts[1], value);
}

/// Writes what scales with the length of a link; `before`: the scene before that change.
void SceneEdit::write_lengths(const BodyScene& before) {
  const Robot& robot = scene_.robot;
  const auto write = [](TomlEdit& file, const Path& list, const std::string& name, const char* key,
                        const landing::Place& now, const landing::Place& old) {
    if (now.along == old.along) return;
    Path table = list;
    table.push_back(index_of(file, list, name));
    set_element(file, table, key, 0, now.along);
  };
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const Link &l = robot.links[i], &old = before.robot.links[i];
    write(robot_file(), {"robot", "link"}, l.name, "com", l.com, old.com);
    write(robot_file(), {"robot", "link"}, l.name, "at", l.at, old.at);
    if (l.inertia_com != old.inertia_com)
      tools::set_number(robot_file(), "robot.link." + l.name + ".inertia_com", l.inertia_com);
  }
  for (std::size_t i = 0; i < robot.contacts.size(); ++i)
    write(robot_file(), {"robot", "contact"}, robot.contacts[i].name, "at", robot.contacts[i].at,
          before.robot.contacts[i].at);
  for (std::size_t i = 0; i < robot.pushes.size(); ++i)
    write(robot_file(), {"robot", "push"}, robot.pushes[i].name, "at", robot.pushes[i].at, before.robot.pushes[i].at);
  for (std::size_t i = 0; i < scene_.loads.size(); ++i)
    write(file_, {"load"}, scene_.loads[i].name, "at", scene_.loads[i].at, before.loads[i].at);
  if (robot.peak.along != before.robot.peak.along && robot_file().has({"robot"}, "peak"))
    set_element(robot_file(), {"robot", "peak"}, "at", 0, robot.peak.along);
}

std::map<std::string, std::string> SceneEdit::kept(const std::optional<double>& height, const std::string& comments,
                                                   const std::string& folder,
                                                   const std::vector<GivenDrive>& drives) const {
  std::map<std::string, std::string> out;
  TomlEdit file = file_;
  std::optional<TomlEdit> apart = robot_;
  CsvWriter head;
  head.comment(comments);
  rebase_drives(scene_.robot, file.path(), folder, file);
  const std::string given = drive_tables(scene_, drives, file, apart ? *apart : file, folder);
  if (apart && apart->text() != robot_before_) {
    rebase_drives(scene_.robot, apart->path(), folder, *apart);
    out["set_robot.toml"] = head.text() + apart->text();
    file.set({}, "robot", std::string("set_robot.toml"));
  } else if (apart) {
    file.set({}, "robot", relative_to(apart->path(), folder));
  }
  if (height && file.has({}, "drop"))
    file.set({"drop"}, "height", *height);
  else if (height)
    file.append(fmt::format("\n[drop]\nheight = {}\npitch_deg = 0\n", shortest(*height)));
  file.append(given);
  out["set_scene.toml"] = head.text() + file.text();
  return out;
}

Texts SceneEdit::texts() const {
  Texts out = {{file_.path(), file_.text()}};
  if (robot_) out[robot_->path()] = robot_->text();
  return out;
}

}  // namespace ukemi::tools

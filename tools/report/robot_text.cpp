#include "tools/report/robot_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "common/csv.hpp"
#include "common/degrees.hpp"
#include "common/error.hpp"
#include "common/toml_edit.hpp"
#include "common/uncertainty_file.hpp"
#include "landing/body/places.hpp"
#include "tools/report/body_scene_text.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

using Path = TomlEdit::Place;

std::vector<std::string> parts_of(const std::string& name) {
  std::vector<std::string> out;
  for (std::size_t begin = 0, end; begin <= name.size(); begin = end + 1) {
    end = std::min(name.find('.', begin), name.size());
    out.push_back(name.substr(begin, end - begin));
  }
  return out;
}

/// Links and contacts stand in the file in any order.
std::string index_of(const TomlEdit& file, const Robot& robot, const char* kind, const std::string& name) {
  for (std::size_t k = 0; k < robot.links.size() + robot.contacts.size(); ++k)
    if (file.text_at({"robot", kind, std::to_string(k)}, "name") == name) return std::to_string(k);
  throw InputError(std::string(kind) + " " + quoted(name) + ": it stands in the file in a way that cannot be followed");
}

void set_link(TomlEdit& file, const DrivenRobot& robot, const std::string& link, const std::string& key, double value) {
  const Path table = {"robot", "link", index_of(file, robot.scene.robot, "link", link)};
  if (key != "com") return file.set(table, key, value);
  for (const Link& l : robot.scene.robot.links)
    if (l.name == link)
      file.set_raw(table, "com", fmt::format("[{}, {}]", shortest(l.com.along), shortest(l.com.across)));
}

/// robot.contact.NAME.KEY, or .pad.KEY.
void set_contact(TomlEdit& file, const Robot& robot, const std::vector<std::string>& parts, double value) {
  Path table = {"robot", "contact", index_of(file, robot, "contact", parts[2])};
  if (parts[3] == "pad") table.push_back("pad");
  file.set(table, parts.back(), value);
}

void set_drive(TomlEdit& file, const std::string& joint, const std::string& key, double value) {
  const Path table = {"drive", joint};
  if (const std::string other = file.text_at(table, "file"); !other.empty())
    throw InputError(
        fmt::format("drive.{}.{}: the drive stands in a file of its own, {}: its constants are needed here", joint, key,
                    quoted(other)));
  if (key.ends_with("_deg")) file.remove(table, key.substr(0, key.size() - 4));
  file.set(table, key, value);
}

void set_stop(TomlEdit& file, const Robot& robot, const std::string& name, const std::string& key, double value) {
  const Path table = {"stop", name};
  if (key == "stiffness" || key == "damping") return file.set(table, key, value);
  const auto stop =
      std::find_if(robot.stops.begin(), robot.stops.end(), [&](auto& s) { return stop_name(robot, s) == name; });
  const bool rail = stop->joint < 0;
  const double unit = rail ? 1 : kDegree;
  file.remove(table, "phi");
  file.set_raw(table, rail ? "s" : "phi_deg",
               fmt::format("[{}, {}]", shortest(stop->ends[0] / unit), shortest(stop->ends[1] / unit)));
}

/// [command], [sensor] and their tables, which need not be there yet.
void set_beside(TomlEdit& file, const std::vector<std::string>& parts, double value, std::string& appended) {
  const bool shared = parts.size() == 2;
  const std::string &kind = parts[0], &key = parts.back();
  const Path table = shared ? Path{kind} : Path{kind, parts[1]};
  const bool there = file.has({}, kind) && (shared || file.has({kind}, parts[1]));
  if (there) return file.set(table, key, value);
  const std::string head = fmt::format("\n[{}]\n", shared ? kind : kind + "." + parts[1]);
  if (appended.find(head) == std::string::npos) appended += head;
  appended.insert(appended.find(head) + head.size(), fmt::format("{} = {}\n", key, shortest(value)));
}

std::string names_text(const std::vector<std::string>& all) {
  return all.empty() ? "[]" : fmt::format("[\"{}\"]", fmt::join(all, "\", \""));
}

std::string verdicts_text(const Verdicts& all) {
  std::vector<std::string> constants, verdicts;
  for (const auto& [constant, verdict] : all) constants.push_back(constant), verdicts.push_back(verdict);
  return fmt::format("constants = {}\nverdicts = {}\n", names_text(constants), names_text(verdicts));
}

std::string errors_text(const Identified& known) {
  std::vector<std::string> outputs, rms;
  for (const auto& [output, left] : known.rms) outputs.push_back(output), rms.push_back(shortest(left));
  return fmt::format("order = {}\n{}outputs = {}\nrms = [{}]\n", names_text(known.constants.order),
                     covariance_lines(known.constants.covariance), names_text(outputs), fmt::join(rms, ", "));
}

}  // namespace

std::string robot_text(const std::string& path, const DrivenRobot& robot,
                       const std::vector<std::pair<std::string, double>>& values, const std::string& comments,
                       const std::string& folder) {
  const std::string& own = robot.scene.robot_file;
  TomlEdit file(own.empty() ? path : own);
  std::string appended;
  for (const auto& [name, value] : values) {
    const std::vector<std::string> parts = parts_of(name);
    if (parts[0] == "command" || parts[0] == "sensor")
      set_beside(file, parts, value, appended);
    else if (parts[0] == "drive")
      set_drive(file, parts[1], parts[2], value);
    else if (parts[0] == "stop")
      set_stop(file, robot.scene.robot, parts[1], parts[2], value);
    else if (parts[1] == "contact")
      set_contact(file, robot.scene.robot, parts, value);
    else if (parts[1] == "rail")
      file.set({"robot", "rail"}, parts[2], value);
    else if (parts.size() == 2)
      file.set({parts[0]}, parts[1], value);
    else
      set_link(file, robot, parts[2], parts[3], value);
  }
  // The scene's [floor] does not come along.
  for (const ContactPoint& c : own.empty() ? std::vector<ContactPoint>{} : robot.scene.robot.contacts)
    write_own_law(c, file, {"robot", "contact", index_of(file, robot.scene.robot, "contact", c.name)});
  move_drives(robot.scene.robot, own.empty() ? path : own, folder, file);
  file.remove_table("identified");
  file.append(appended);
  if (const Verdicts& verdicts = robot.scene.robot_verdicts; robot.known || !verdicts.empty())
    file.append("\n[identified]\n" + (robot.known ? errors_text(*robot.known) : "") + verdicts_text(verdicts));
  CsvWriter head;
  head.comment(comments);
  return head.text() + file.text();
}

}  // namespace ukemi::tools

#include "tools/report/robot_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/csv.hpp"
#include "common/degrees.hpp"
#include "common/error.hpp"
#include "common/toml_edit.hpp"
#include "common/uncertainty_file.hpp"
#include "landing/body/places.hpp"
#include "tools/report/body_scene_text.hpp"
#include "tools/report/robot_edit.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

using Path = TomlEdit::Place;

/// Sets a number of [command], [sensor] or a subtable; tables that the file lacks go to `appended`.
void set_in_table(TomlEdit& file, const std::vector<std::string>& parts, double value, std::string& appended) {
  const bool top_level = parts.size() == 2;
  const std::string &kind = parts[0], &key = parts.back();
  const Path table = top_level ? Path{kind} : Path{kind, parts[1]};
  const bool exists = file.has({}, kind) && (top_level || file.has({kind}, parts[1]));
  if (exists) return file.set(table, key, value);
  const std::string head = fmt::format("\n[{}]\n", top_level ? kind : kind + "." + parts[1]);
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

std::string errors_text(const FitUncertainty& known) {
  std::vector<std::string> outputs, rms;
  for (const auto& [output, residual_rms] : known.rms) outputs.push_back(output), rms.push_back(shortest(residual_rms));
  return fmt::format("order = {}\n{}outputs = {}\nrms = [{}]\n", names_text(known.constants.order),
                     covariance_lines(known.constants.covariance), names_text(outputs), fmt::join(rms, ", "));
}

}  // namespace

std::string robot_text(const std::string& path, const DrivenRobot& robot,
                       const std::vector<std::pair<std::string, double>>& values, const std::string& comments,
                       const std::string& folder) {
  const std::string& robot_file = robot.scene.robot_file;
  TomlEdit file(robot_file.empty() ? path : robot_file);
  std::string appended;
  for (const auto& [name, value] : values) {
    const std::vector<std::string> parts = split_name(name);
    if (parts[0] == "command" || parts[0] == "sensor")
      set_in_table(file, parts, value, appended);
    else
      set_number(file, name, value);
  }
  // The robot's file lacks the scene's [floor].
  for (const ContactPoint& c : robot_file.empty() ? std::vector<ContactPoint>{} : robot.scene.robot.contacts)
    write_contact_law(c, file, {"robot", "contact", index_of(file, {"robot", "contact"}, c.name)});
  rebase_drives(robot.scene.robot, robot_file.empty() ? path : robot_file, folder, file);
  file.remove_table("identified");
  file.append(appended);
  if (const Verdicts& verdicts = robot.scene.robot_verdicts; robot.known || !verdicts.empty())
    file.append("\n[identified]\n" + (robot.known ? errors_text(*robot.known) : "") + verdicts_text(verdicts));
  CsvWriter head;
  head.comment(comments);
  return head.text() + file.text();
}

}  // namespace ukemi::tools

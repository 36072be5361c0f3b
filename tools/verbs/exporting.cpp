#include "tools/verbs/exporting.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "common/error.hpp"
#include "tools/program/arguments.hpp"

namespace ukemi::tools {

namespace {

/// Checks that URDF, MJCF and ROS all accept a joint's name.
std::string joint_name(const std::string& text) {
  const bool valid = !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) {
    return (std::isalnum(c) && c < 128) || c == '_' || c == '-' || c == '.' || c == '/';
  });
  if (!valid) throw InputError("--joint: " + quoted(text) + ": letters, digits, '_', '-', '.' and '/' are needed");
  return text;
}

}  // namespace

ExportChoices landing_exports() {
  return {{{"ros2", Exports::Format::kRos2}, {"plotjuggler", Exports::Format::kPlotJuggler}},
          "ros2: motion_ros2.yaml, a JointTrajectory; plotjuggler: plotjuggler.csv, the landing's rows"};
}

ExportChoices actuator_exports() {
  return {{{"mjcf", Exports::Format::kMjcf}, {"urdf", Exports::Format::kUrdf}},
          "mjcf: actuator.mjcf.xml, for MuJoCo; urdf: actuator.urdf.xml"};
}

void check_exports(const Exports& exports, const landing::Robot& robot) {
  std::vector<std::string> names;
  for (const landing::Joint& j : robot.joints)
    if (j.driven()) names.push_back(j.name);
  if (exports.has(Exports::Format::kRos2) && names.empty())
    throw InputError("--export: ros2: no joint of this robot is driven: there is no motion to send");
  if (exports.joint && names.size() != 1)
    throw InputError(
        fmt::format("--joint: {}: a robot with one driven joint is needed; the joints of this one keep "
                    "their names: {}",
                    quoted(*exports.joint), fmt::join(names, ", ")));
}

void add_export(CLI::App& verb, Exports& exports, const ExportChoices& choices) {
  verb.add_option_function<std::string>(
          "--export",
          [&exports, formats = choices.formats](const std::string& list) {
            for (const std::string& name : split(list)) exports.formats.push_back(choice("--export", name, formats));
          },
          choices.help)
      ->type_name("LIST");
  verb.add_option_function<std::string>(
          "--joint", [&exports](const std::string& name) { exports.joint = joint_name(name); },
          "with --export, the joint's name [knee; of a robot of links its own]")
      ->type_name("NAME");
}

}  // namespace ukemi::tools

#include "tools/verbs/exporting.hpp"

#include <algorithm>
#include <cctype>

#include "common/error.hpp"
#include "tools/program/arguments.hpp"

namespace ukemi::tools {

namespace {

/// A joint's name as URDF, MJCF and ROS all take it.
std::string joint_name(const std::string& text) {
  const bool right = !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) {
    return (std::isalnum(c) && c < 128) || c == '_' || c == '-' || c == '.' || c == '/';
  });
  if (!right) throw InputError("--joint: " + quoted(text) + ": letters, digits, '_', '-', '.' and '/' are needed");
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
          "with --export, the joint's name [knee]")
      ->type_name("NAME");
}

}  // namespace ukemi::tools

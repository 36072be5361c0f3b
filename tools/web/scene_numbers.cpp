#include "tools/web/scene_numbers.hpp"

#include <algorithm>
#include <array>
#include <filesystem>

#include "common/actuator_constants.hpp"
#include "common/degrees.hpp"
#include "common/error.hpp"
#include "common/files.hpp"
#include "common/toml.hpp"
#include "common/toml_edit.hpp"
#include "landing/body/body_scene.hpp"
#include "landing/body/robot_file.hpp"

namespace ukemi::tools {

namespace {

struct DropNumber {
  const char *key, *words, *unit;
  double low, high;
};
constexpr std::array<DropNumber, 4> kDrop = {{{"height", "drop height", "m", 0, 1},
                                              {"pitch", "pitch at release", "deg", -90, 90},
                                              {"forward_speed", "forward speed", "m/s", -2, 2},
                                              {"pitch_rate", "pitch rate", "rad/s", -5, 5}}};
struct FloorNumber {
  const char *key, *words, *unit;
};
constexpr std::array<FloorNumber, 5> kFloor = {{{"stiffness", "stiffness", "N/m"},
                                                {"damping_normal", "damping, normal", "N/(m/s)"},
                                                {"damping_tangential", "damping, tangential", "N/(m/s)"},
                                                {"stiffness_tangential", "stiffness, tangential", "N/m"},
                                                {"friction", "friction", "1"}}};

/// A number of [drop] with its value in the file; its range is widened to contain the value.
SceneNumber of_drop(const DropNumber& n, TomlSection& drop) {
  const bool angle = n.unit == std::string("deg");
  const double value = angle ? drop.angle(n.key) * kDegrees : drop.optional_number(n.key, Range::any()).value_or(0);
  return {std::string("drop.") + n.key + (angle ? "_deg" : ""),
          n.words,
          n.unit,
          value,
          std::min(n.low, 2 * value),
          std::max(n.high, 2 * value),
          false};
}
SceneNumber of_floor(const FloorNumber& n, double value) {
  constexpr double kFactor = 10, kMax = 100;  // range of a positive number; maximum of one that is 0
  const std::string name = std::string("floor.") + n.key;
  if (value > 0) return {name, n.words, n.unit, value, value / kFactor, value * kFactor, true};
  return {name, n.words, n.unit, value, 0, kMax, false};
}

/// Replaces the file name in the table of a joint's drive by the drive's constants.
void set_constants(TomlEdit& edit, const landing::Joint& joint) {
  const TomlEdit::Place drive{"drive", joint.name};
  if (edit.text_at(drive, "file").empty()) return;
  edit.remove(drive, "file");
  if (joint.motor_torque_max) edit.set(drive, "motor_torque_max", *joint.motor_torque_max);
  if (joint.speed_max) edit.set(drive, "speed_max", *joint.speed_max);
  if (joint.sea.feedback == Feedback::kMotor) edit.set(drive, "feedback", std::string(name(joint.sea.feedback)));
  const auto& constants = actuator_constants();
  for (std::size_t k = constants.size(); k-- > 0;) {  // each is inserted before the previous ones
    const double value = joint.sea.*constants[k].at;
    if (k < kConstants || value != constants[k].absent) edit.set(drive, constants[k].key, value);
  }
}

}  // namespace

std::vector<SceneNumber> scene_numbers(const std::string& scene, const std::vector<std::string>& drop_keys) {
  TomlFile file(scene);
  std::vector<SceneNumber> out;
  TomlSection drop = file.require("drop");
  for (const DropNumber& n : kDrop)
    if (std::find(drop_keys.begin(), drop_keys.end(), n.key) != drop_keys.end()) out.push_back(of_drop(n, drop));
  if (auto floor = file.optional("floor"))
    for (const FloorNumber& n : kFloor)
      if (const auto value = floor->optional_number(n.key, Range::any())) out.push_back(of_floor(n, *value));
  return out;
}

std::string with_numbers(const std::string& scene, const std::map<std::string, double>& numbers) {
  TomlEdit edit(scene);
  for (const auto& [name, value] : numbers) {
    const std::size_t dot = name.find('.');
    const TomlEdit::Place table{name.substr(0, dot)};
    const std::string key = name.substr(dot + 1);
    if (key == "pitch_deg") edit.remove(table, "pitch");  // the key in radians
    edit.set(table, key, value);
  }
  return edit.text();
}

std::string whole_scene(const std::string& scene) {
  const std::string own = read_text_file(scene);
  if (!landing::is_of_links(scene)) return own;
  const std::filesystem::path folder = std::filesystem::path(scene).parent_path();
  try {
    TomlEdit edit(scene);
    if (const std::string robot = edit.text_at({}, "robot"); !robot.empty()) {
      edit.remove({}, "robot");
      edit.append("\n" + read_text_file((folder / robot).string()));
    }
    const std::string joined = (folder / "joined.toml").string();
    write_file(joined, edit.text());
    TomlEdit whole(joined);
    for (const landing::Joint& joint : landing::read_robot(scene).robot.joints) set_constants(whole, joint);
    return whole.text();
  } catch (const InputError&) {
    return own;
  }
}

}  // namespace ukemi::tools

#include "tools/verbs/given_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/degrees_doubt.hpp"
#include "common/error.hpp"
#include "landing/body/robot_file.hpp"
#include "landing/model/scene_file.hpp"
#include "tools/program/arguments.hpp"

namespace ukemi::tools {

using namespace landing;

namespace {

/// An angle of --hold [deg].
double held_degrees(const std::string& text, Run& run) {
  const double out = to_number("--hold", text);
  if (std::abs(out) > 360) throw InputError(fmt::format("--hold: {}: degrees from -360 to 360 are needed", out));
  if (const std::string doubt = radians_doubt("--hold", out); !doubt.empty()) run.warn(doubt);
  return out;
}

/// The motion that holds every driven joint: as in the scene, or at NAME=DEG,... without a move in the air; with a
/// single driven joint DEG alone is allowed.
BodyMotion posture(const BodyScene& scene, const std::string& text, Run& run) {
  BodyMotion out = held_posture(scene);
  std::vector<std::string> names;
  for (const Joint& j : scene.robot.joints)
    if (j.driven()) names.push_back(j.name);
  std::vector<std::string> held;
  for (const std::string& item : split(text)) {
    const bool plain = item.find('=') == std::string::npos && names.size() == 1;
    const Assignment a = plain ? Assignment{names[0], item} : assignment("--hold", item);
    const std::string& name = names.empty() ? a.name : names[choice_index("--hold", a.name, names)];
    if (std::find(held.begin(), held.end(), name) != held.end())
      throw InputError("--hold: " + quoted(name) + ": named twice");
    held.push_back(name);
    const double degrees = held_degrees(a.value, run);
    for (std::size_t i = 0; i < out.size(); ++i)
      if (scene.robot.joints[i].driven() && scene.robot.joints[i].name == name)
        out[i].phi_i = out[i].phi_f = degrees * kDegree, out[i].reposition.reset();
  }
  if (names.empty() && !text.empty()) throw InputError("--hold: no joint of this robot is driven");
  return out;
}

}  // namespace

void add_motion(CLI::App& verb, MotionArguments& a) {
  verb.add_option("--motion", a.file, "motion file: TOML, or the rows of a motion.csv");
  verb.add_option(
          "--hold", a.hold,
          "hold the reference at this angle [deg], of a robot of links JOINT=DEG,...; the joint stays compliant")
      ->type_name("DEG");
}

Motion motion_of(const MotionArguments& a, const std::string& verb, Run& run) {
  if (a.file.empty() == !a.hold) throw InputError(verb + ": one of --motion FILE and --hold DEG is needed");
  if (a.hold) {
    const double hold = held_degrees(*a.hold, run);
    return {hold / kDegrees, hold / kDegrees, 1};
  }
  run.input(a.file);
  return read_motion(a.file);
}

BodyMotion motion_of(const BodyScene& scene, const MotionArguments& a, Run& run) {
  if (!a.file.empty() && a.hold) throw InputError("--motion, --hold: one of them is needed, not both");
  if (a.file.empty()) return posture(scene, a.hold.value_or(""), run);
  run.input(a.file);
  return read_body_motion(a.file, scene.robot);
}

}  // namespace ukemi::tools

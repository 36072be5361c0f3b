#include "landing/body/command_path.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace ukemi::landing {

namespace {

struct Key {
  const char* key;
  double CommandPath::Joint::*at;
};
constexpr Key kKeys[] = {{"torque_gain", &CommandPath::Joint::torque_gain},
                         {"torque_low", &CommandPath::Joint::torque_low},
                         {"torque_high", &CommandPath::Joint::torque_high},
                         {"offset", &CommandPath::Joint::offset}};

}  // namespace

double* command_number(CommandPath& path, const Robot& robot, const std::string& name) {
  if (name == "delay") return &path.delay;
  for (std::size_t i = 0; i < robot.joints.size(); ++i)
    for (const Key& k : kKeys)
      if (robot.joints[i].driven() && name == robot.joints[i].name + "." + k.key) return &(path.joints[i].*k.at);
  return nullptr;
}

CommandPath read_command_path(TomlFile& file, const Robot& robot) {
  CommandPath out{.joints = std::vector<CommandPath::Joint>(robot.joints.size())};
  for (std::size_t i = 0; i < robot.joints.size(); ++i)
    if (robot.joints[i].kind == DriveKind::kGeared)
      out.joints[i].torque_high = robot.joints[i].sea.tau_max, out.joints[i].torque_low = -robot.joints[i].sea.tau_max;
  auto s = file.optional("command");
  if (!s) return out;
  const Range delay_range{0, kMaxCommandDelay, false, fmt::format("from 0 to {:g} s", kMaxCommandDelay)},
      non_positive{-std::numeric_limits<double>::max(), 0, false, "at most 0"};
  const auto range = [&](const Key& k) {
    if (k.at == &CommandPath::Joint::offset) return Range::any();
    return k.at == &CommandPath::Joint::torque_low ? non_positive : Range::positive();
  };
  out.delay = s->optional_number("delay", delay_range).value_or(0);
  out.rows = int(s->optional_count("rows", 0, kMaxCommandRows).value_or(0));
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const Joint& joint = robot.joints[i];
    auto table = s->optional_section(joint.name);
    if (!table) continue;
    if (!joint.driven())
      s->fail(joint.name, std::string("the joint is ") + name(joint.kind) + ": a joint that is driven is needed");
    for (const Key& k : kKeys)
      if (const auto v = table->optional_number(k.key, range(k))) out.joints[i].*k.at = *v;
  }
  return out;
}

void apply(const CommandPath& path, Robot& robot) {
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    Joint& joint = robot.joints[i];
    if (joint.kind != DriveKind::kGeared) continue;
    const CommandPath::Joint& c = path.joints[i];
    joint.sea.k_p *= c.torque_gain, joint.sea.k_d *= c.torque_gain;
    joint.sea.tau_max = c.torque_gain * std::min(-c.torque_low, c.torque_high);
  }
}

}  // namespace ukemi::landing

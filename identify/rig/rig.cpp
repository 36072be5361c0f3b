#include "identify/rig/rig.hpp"

#include <cmath>

#include "common/actuator.hpp"
#include "common/actuator_constants.hpp"
#include "common/checks.hpp"
#include "common/degrees.hpp"
#include "common/toml.hpp"

namespace ukemi::identify {

void Rig::validate() const {
  check_range("rig: length", length, Range::link_length()), check_positive("rig: inertia", inertia);
  if (tau_max) check_not_negative("rig: tau_max", *tau_max);
  if (gear_ratio) check_positive("rig: gear_ratio", *gear_ratio);
  if (speed_max) check_positive("rig: speed_max", *speed_max);
  if (motor_torque_max) check_positive("rig: motor_torque_max", *motor_torque_max);
  check_not_negative("rig: gravity_moment", gravity.moment), check_finite("rig: hanging", gravity.hanging);
  if (drive.kind == Drive::Kind::kController) check_positive("rig: command_gain", drive.gain);
  constexpr double kNone = std::numeric_limits<double>::infinity();
  if (drive.limit != kNone) check_positive("rig: command_limit", drive.limit);
  if (drive.rate != kNone) check_positive("rig: command_rate", drive.rate);
  if (drive.control_delay) check_range("rig: control_delay", *drive.control_delay, delay_range());
  if (drive.velocity_filter) check_range("rig: velocity_filter", *drive.velocity_filter, delay_range());
  for (const RigErrorKey& k : rig_error_keys()) check_not_negative(std::string("rig: errors: ") + k.key, errors.*k.at);
}

namespace {

Drive read_drive(TomlSection& s, std::optional<Feedback> feedback) {
  Drive out{.kind = Drive::Kind::kCommand};
  out.control_delay = s.optional_number("control_delay", delay_range());
  out.velocity_filter = s.optional_number("velocity_filter", delay_range());
  const bool has_lag = out.control_delay || out.velocity_filter;
  if (const auto gain = s.optional_number("command_gain", Range::positive()))
    out.kind = Drive::Kind::kController, out.gain = *gain;
  if (const auto limit = s.optional_number("command_limit", Range::positive())) out.limit = *limit;
  const auto side = read_feedback(s);
  const auto angle = s.optional_choice("angle", {"predicted", "logged"});
  for (const auto& [key, given] : {std::pair("feedback", side.has_value()), {"angle", angle.has_value()}})
    if (given && out.kind == Drive::Kind::kCommand) s.fail(key, "without command_gain it has no effect");
  out.feedback = side ? side : feedback;
  if (angle == "logged") out.angle = Drive::Angle::kLogged;
  if (const auto rate = s.optional_number("command_rate", Range::positive())) {
    if (!out.known_command())
      s.fail("command_rate", "a command that is known is needed: angle = \"logged\", or no command_gain");
    out.rate = *rate;
  } else if (out.kind == Drive::Kind::kCommand && has_lag && !std::isfinite(out.limit)) {
    out.kind = Drive::Kind::kGains;
  }
  return out;
}

RigErrors read_errors(TomlSection& s) {
  const bool exact = s.optional_flag("exact").value_or(false);
  RigErrors out = exact ? RigErrors::exact() : RigErrors{};
  for (const auto& [key, at, unit] : rig_error_keys()) {
    const auto error =
        unit == RigErrorKey::Unit::kPart ? s.optional_part(key) : s.optional_number(key, Range::non_negative());
    if (error && exact) s.fail(key, "given beside exact = true, with which every error is 0");
    if (error) out.*at = *error;
  }
  return out;
}

}  // namespace

const std::vector<RigErrorKey>& rig_error_keys() {
  using enum RigErrorKey::Unit;
  static const std::vector<RigErrorKey> keys{
      {"inertia", &RigErrors::inertia, kPart},          {"length", &RigErrors::length, kPart},
      {"force_gain", &RigErrors::force_gain, kPart},    {"encoder_gain", &RigErrors::encoder_gain, kPart},
      {"delay", &RigErrors::delay, kSeconds},           {"filter", &RigErrors::filter, kSeconds},
      {"time_shift", &RigErrors::time_shift, kSeconds},
  };
  return keys;
}

Rig read_rig(const std::string& path) {
  TomlFile file(path);
  TomlSection s = file.require("rig");
  Rig rig;
  rig.length = s.number("length", Range::link_length());
  const auto joint = s.optional_number("inertia_joint", Range::positive());
  const auto mass = s.optional_number("mass", Range::positive());
  const auto com = s.optional_number("inertia_com", Range::positive());
  if (joint && (mass || com))
    s.fail("inertia_joint", "given beside mass and inertia_com: one of the two forms is needed");
  if (!joint && !(mass && com))
    s.fail("inertia_joint", "the key is missing: inertia_joint, or mass and inertia_com, is needed");
  rig.inertia = joint ? *joint : *com + *mass * 0.25 * rig.length * rig.length;
  rig.tau_max = s.optional_number("tau_max", Range::non_negative());
  rig.speed_max = s.optional_number("speed_max", Range::positive());
  rig.motor_torque_max = s.optional_number("motor_torque_max", Range::positive());
  rig.gear_ratio = s.optional_number("gear_ratio", Range::positive());
  rig.feedback = read_feedback(s);
  const auto moment = s.optional_number("gravity_moment", Range::non_negative());
  const auto hanging = s.optional_number("hanging_deg", Range{-360, 360, false, "degrees from -360 to 360"});
  if (hanging && !moment) s.fail("hanging_deg", "without gravity_moment it has no effect");
  rig.gravity = {moment.value_or(0), hanging.value_or(0) / kDegrees};
  if (const auto stop = file.optional("stop"))
    stop->fail("",
               "[stop]: a rig has none: describe it as a robot of one link, base = \"pinned\", with [stop.JOINT], "
               "and give that as --robot");
  if (auto drive = file.optional("drive")) rig.drive = read_drive(*drive, rig.feedback);
  if (auto errors = file.optional("errors")) rig.errors = read_errors(*errors);
  file.finish();
  return rig;
}

}  // namespace ukemi::identify

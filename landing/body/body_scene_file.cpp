#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "common/checks.hpp"
#include "common/csv.hpp"
#include "common/degrees.hpp"
#include "common/eigen.hpp"
#include "common/uncertainty_file.hpp"
#include "landing/body/command_path.hpp"
#include "landing/body/floor_constants.hpp"
#include "landing/body/load.hpp"
#include "landing/body/places.hpp"
#include "landing/body/robot_file.hpp"
#include "landing/body/sensors.hpp"
#include "landing/model/scatter_file.hpp"
#include "landing/model/scene_file.hpp"

namespace ukemi::landing {

namespace {

constexpr double kMaxDelay = 0.1;  ///< detection [s]

void read_floor(TomlFile& file, BodyScene& scene, ContactLaw& law) {
  auto floor = file.optional("floor");
  if (!floor) return;
  law = read_law(*floor, std::nullopt);
  scene.floor = true;
  scene.slope = floor->optional_angle("slope").value_or(0);
  if (!(std::abs(scene.slope) < 90 * kDegree))
    floor->fail("slope_deg", shortest(scene.slope * kDegrees) + ": an angle between -90 and 90 is needed");
  scene.source = floor->optional_text("source").value_or("");
}

void read_drop(TomlSection& s, const Robot& robot, Drop& drop) {
  const Joint* const pin = robot.base == Base::kPinned ? robot.joint_of(0) : nullptr;
  drop.pitch = pin && pin->driven() ? s.optional_angle("pitch").value_or(0) : s.angle("pitch");
  const auto refuse = [&](const char* key, const char* why) {
    if (s.has(key)) s.fail(key, why);
  };
  if (robot.base == Base::kPinned) {
    refuse("height", "a pinned robot is not dropped"), refuse("forward_speed", "a pinned robot is not dropped");
    if (pin) refuse("pitch_rate", "the pin's own joint moves the first link");
  } else {
    drop.height = s.number("height", {0, 1e4, false, "at least 0 and at most 1e4"});
    if (robot.base == Base::kRail) {
      refuse("forward_speed", "a robot on a rail has none");
      refuse("pitch_rate", "the first link of a robot on a rail keeps its angle");
    }
    drop.forward_speed = s.optional_number("forward_speed", Range::any()).value_or(0);
  }
  drop.pitch_rate = s.optional_number("pitch_rate", Range::any()).value_or(0);
}

/// [low, high] of phi_deg.
std::optional<std::array<double, 2>> angle_range(TomlSection& s) {
  const auto phi = s.optional_angle_pair("phi");
  if (phi && !((*phi)[0] < (*phi)[1])) s.fail("phi_deg", "the range is empty: [low, high] with low < high is needed");
  return phi;
}

/// Calls f(table, index) for each of Robot::joints with a table in `s`; it must be driven. A single driven joint needs
/// no table of its own: `s` is then its table, if it has an angle.
template <class F>
void for_each_driven(TomlSection& s, const Robot& robot, F&& f) {
  const std::optional<std::size_t> only = sole_driven_joint(robot);
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const Joint& joint = robot.joints[i];
    auto section = s.optional_section(joint.name);
    if (!section && only == i && (s.has("phi") || s.has("phi_deg") || s.has("hold") || s.has("hold_deg"))) section = s;
    if (!section) continue;
    if (!joint.driven())
      s.fail(joint.name, std::string("the joint is ") + name(joint.kind) + ": a joint that is driven is needed");
    f(*section, i);
  }
}

void read_search(TomlSection& s, const Robot& robot, BodyScene& scene) {
  if (const auto d = s.optional_numbers("duration", 2, Range::positive())) {
    if (!((*d)[0] < (*d)[1])) s.fail("duration", "the range is empty: [low, high] with low < high is needed");
    scene.duration = {(*d)[0], (*d)[1]};
  }
  for_each_driven(s, robot, [&](TomlSection& section, std::size_t i) {
    JointSearch& search = scene.search[i];
    if (const auto phi = angle_range(section)) search.phi = *phi;
    search.hold = section.optional_angle("hold");
  });
}

/// Reads [release] from, [release.JOINT] phi_deg, rate_deg; every driven joint needs its table.
void read_release(TomlSection& s, const Robot& robot, BodyScene& scene) {
  BodyRelease release{.joints = std::vector<BodyRelease::Joint>(robot.joints.size())};
  release.from = s.optional_number("from", Range::non_negative()).value_or(0);
  std::vector<bool> present(robot.joints.size(), false);
  for_each_driven(s, robot, [&](TomlSection& section, std::size_t i) {
    release.joints[i] = {section.angle("phi"), section.optional_rate("rate").value_or(0)};
    present[i] = true;
  });
  for (std::size_t i = 0; i < present.size(); ++i)
    if (robot.joints[i].driven() && !present[i])
      s.fail(robot.joints[i].name,
             fmt::format("a table [release.{}] is needed: the joint is driven", robot.joints[i].name));
  scene.release = release;
}

/// Reads [joint.JOINT] phi_deg, the stops of joints, as limits.
std::vector<Load> read_stops(TomlFile& file, const Robot& robot) {
  std::vector<Load> out;
  if (auto stops = file.optional("joint"))
    for_each_driven(*stops, robot, [&](TomlSection& section, std::size_t i) {
      if (const auto phi = angle_range(section)) out.push_back(limit(robot, Load::Kind::kAngle, i, 0, *phi));
    });
  return out;
}

/// Throws InputError on the first of these tables that a file has; `home`: where such tables belong.
void refuse_tables(TomlFile& file, std::initializer_list<const char*> names, const std::string& home) {
  for (const char* name : names)
    if (auto s = file.optional(name)) s->fail("", "it belongs into " + home);
}

/// [robot] of a scene that names no robot's file.
TomlSection require_robot(TomlFile& file) {
  try {
    return file.require("robot");
  } catch (const InputError& e) {
    throw InputError(std::string(e.what()) + ": it, or robot = \"FILE\" above all tables, says which robot falls");
  }
}

/// Default law of contacts without [floor].
constexpr ContactLaw kNoFloor{.stiffness = 1};

/// Use of a file: a landing with the file's drop, a landing with another drop, or trials.
enum class Use { kLanding, kDrop, kDriven };

/// From [identified] the covariance of the robot's constants that matter in landings; torque gains relative to their
/// values. Drives given on the command line are excluded.
std::optional<Uncertainty> read_identified_errors(TomlSection& known, const CommandPath& commands, const Robot& robot,
                                                  const std::vector<GivenDrive>& drives) {
  if (!known.has("order")) return std::nullopt;
  const std::vector<std::string> none, order = known.optional_texts("order").value_or(none);
  const Uncertainty all = read_uncertainty(known, order, "the robot");
  Uncertainty out;
  std::vector<long> kept;
  std::vector<double> unit;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::string& name = order[i];
    double part = 1;
    for (std::size_t j = 0; j < robot.joints.size(); ++j)
      if (name == gain_name(robot.joints[j])) part = 1 / commands.joints[j].torque_gain;
    const bool of_trials =
        name.starts_with("sensor.") || (name.starts_with("command.") && !name.ends_with(".torque_gain"));
    const bool given = std::any_of(drives.begin(), drives.end(), [&](const GivenDrive& d) {
      return name.starts_with(d.joint.empty() ? "drive." : "drive." + d.joint + ".");
    });
    if (!of_trials && !given) out.order.push_back(name), kept.push_back(long(i)), unit.push_back(part);
  }
  if (kept.empty()) return std::nullopt;
  const Eigen::Map<const Eigen::VectorXd> scale(unit.data(), long(unit.size()));
  out.covariance = Eigen::MatrixXd(scale.asDiagonal() * eigen(all.covariance)(kept, kept) * scale.asDiagonal());
  return out;
}

/// From [identified] the verdict of the fit on each constant; other keys are ignored.
Verdicts read_identified_verdicts(TomlFile& file) {
  Verdicts out;
  auto known = file.optional("identified");
  if (!known) return out;
  for (const char* key : {"order", "covariance", "outputs", "rms"}) known->accept(key);
  const std::vector<std::string> none, constants = known->optional_texts("constants").value_or(none),
                                       verdicts = known->optional_texts("verdicts").value_or(none);
  if (constants.size() != verdicts.size())
    known->fail("verdicts", fmt::format("{} verdicts: 'constants' names {}", verdicts.size(), constants.size()));
  for (std::size_t i = 0; i < constants.size(); ++i) out.emplace_back(constants[i], verdicts[i]);
  return out;
}

BodyScene read(const std::string& path, const std::vector<GivenDrive>& drives, Use use, const Texts& texts = {}) {
  TomlFile file = open_edited(path, texts);
  BodyScene out;
  out.name = std::filesystem::path(path).stem().string();
  ContactLaw law = kNoFloor;
  read_floor(file, out, law);
  CommandPath commands;
  Verdicts robot_verdicts;
  const auto read_fit = [&](TomlFile& of) {
    robot_verdicts = read_identified_verdicts(of);
    if (auto known = of.optional("identified"); known && use != Use::kDriven)
      out.identified = read_identified_errors(*known, commands, out.robot, drives);
  };
  if (const auto name = file.optional_text("robot")) {
    out.robot_file = (std::filesystem::path(path).parent_path() / *name).string();
    TomlFile other = open_edited(out.robot_file, texts);
    read_robot_tables(other, &file, law, drives, out);
    commands = read_command_path(other, out.robot), (void)read_sensors(other, out.robot);
    read_fit(other);
    refuse_tables(file, {"stop", "command", "sensor", "identified"},
                  "the robot's file " + ukemi::quoted(out.robot_file));
    refuse_tables(other,
                  {"floor", "drop", "search", "release", "joint", "motion", "scatter", "uncertainty", "execution",
                   "run", "detection"},
                  "the scene's file " + ukemi::quoted(path));
    other.finish();
  } else {
    (void)require_robot(file);
    read_robot_tables(file, nullptr, law, drives, out);
    commands = read_command_path(file, out.robot), (void)read_sensors(file, out.robot);
    read_fit(file);
  }
  if (use != Use::kDriven) enable_floor(path, use == Use::kDrop ? Contacts::kAll : Contacts::kAllOrNone, out);
  if (use != Use::kDriven) apply(commands, out.robot);
  out.search.resize(out.robot.joints.size());
  if (auto drop = use == Use::kLanding ? file.require("drop") : file.optional("drop"))
    read_drop(*drop, out.robot, out.drop);
  if (auto search = file.optional("search")) read_search(*search, out.robot, out);
  if (auto release = file.optional("release")) read_release(*release, out.robot, out);
  out.loads = read_loads(file, out.robot, read_stops(file, out.robot));
  if (auto motion = file.optional("motion")) {
    out.freedom = read_freedom(*motion);
    out.own_durations = motion->optional_choice("duration", {"shared", "own"}) == "own";
  }
  if (auto scatter = file.optional("scatter")) out.scatter = read_scatter(*scatter, true);
  const std::vector<std::string> constants = floor_constant_names(out.robot);
  if (auto known = file.optional("uncertainty")) out.uncertainty = read_uncertainty(*known, constants, "the scene");
  out.verdicts = read_verdicts(file, constants);
  out.robot_verdicts = std::move(robot_verdicts);
  if (auto execution = file.optional("execution")) out.execution = read_execution(*execution);
  if (auto run = file.optional("run")) out.t_end = run->optional_number("t_end", Range::positive());
  if (auto detection = file.optional("detection")) {
    out.detection_delay = detection->optional_number("delay", Range::non_negative()).value_or(0);
    if (out.detection_delay > kMaxDelay)
      detection->fail("delay", shortest(out.detection_delay) + " s: at most " + shortest(kMaxDelay) + " s is needed");
  }
  file.finish();
  out.validate();
  return out;
}

void check(const BodyRelease& release, const Robot& robot) {
  if (release.joints.size() != robot.joints.size())
    throw InputError(
        fmt::format("release: {}: one for each of {} joints is needed", release.joints.size(), robot.joints.size()));
  for (const BodyRelease::Joint& j : release.joints)
    check_finite("release.phi", j.phi), check_finite("release.rate", j.rate);
  check_not_negative("release.from", release.from);
}

}  // namespace

void BodyScene::validate() const {
  robot.validate();
  if (!(std::abs(slope) < 90 * kDegree))
    throw InputError(fmt::format("slope: {} rad: within a right angle is needed", shortest(slope)));
  check_not_negative("drop.height", drop.height), check_finite("drop.pitch", drop.pitch);
  check_finite("drop.forward_speed", drop.forward_speed), check_finite("drop.pitch_rate", drop.pitch_rate);
  check_finite("drop.vertical_speed", drop.vertical_speed);
  const bool falls = robot.base == Base::kFree || (robot.base == Base::kRail && std::sin(robot.rail_direction) != 0);
  if (drop.vertical_speed != 0 && !falls)
    throw InputError("drop.vertical_speed: 0 is needed: this base keeps the robot from falling");
  if (release) check(*release, robot);
  for (const Load& l : loads) check(l, robot);
  check_not_negative("detection_delay", detection_delay);
  if (t_end) check_positive("t_end", *t_end);
  if (search.size() != robot.joints.size())
    throw InputError(
        fmt::format("search: {}: one for each of {} joints is needed", search.size(), robot.joints.size()));
  const auto rising = [](const char* what, const std::array<double, 2>& range) {
    check_finite(what, range[0]), check_finite(what, range[1]);
    if (!(range[0] < range[1])) throw InputError(std::string(what) + ": the range is empty");
  };
  for (const JointSearch& s : search) rising("search.phi", s.phi), check_finite("search.hold", s.held());
  check_not_negative("execution.phi", execution.phi), check_not_negative("execution.duration", execution.duration);
  if (scatter) scatter->validate();
  check_count("freedom.bumps", freedom.bumps, 0, kMaxBumps), rising("freedom.bump", freedom.bump);
  if (freedom.gains) rising("freedom.gains", *freedom.gains), check_not_negative("freedom.gains", (*freedom.gains)[0]);
  rising("duration", duration), check_positive("duration", duration[0]);
}

bool BodyScene::limited() const {
  return std::any_of(loads.begin(), loads.end(), [](auto& l) { return l.limit; });
}

BodyMotion held_posture(const BodyScene& scene) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  BodyMotion out;
  for (std::size_t i = 0; i < scene.robot.joints.size(); ++i) {
    const Joint& joint = scene.robot.joints[i];
    if (joint.driven() && scene.release) {
      const auto& [phi, rate] = scene.release->joints[i];
      out.push_back({.phi_i = phi, .phi_f = phi, .duration = 1, .reposition = Reposition{phi, rate, kNever, kNever}});
      continue;
    }
    const double phi = joint.driven() ? scene.search[i].held() : joint.phi;
    out.push_back({phi, phi, 1});
  }
  return out;
}

void forbid(BodyScene& scene, const std::vector<std::string>& contacts, const std::string& option) {
  std::vector<std::string> known;
  for (const ContactPoint& c : scene.robot.contacts) known.push_back(c.name);
  for (const std::string& name : contacts) {
    const auto at = std::find(known.begin(), known.end(), name);
    if (at == known.end()) throw InputError(option + ": " + one_of(name, known));
    set_limit(scene, limit(scene.robot, Load::Kind::kTouch, std::size_t(at - known.begin()), 0));
  }
}

std::vector<std::string> respect_ratings(BodyScene& scene, const std::string& option) {
  using Kind = Load::Kind;
  const std::vector<Joint>& joints = scene.robot.joints;
  std::vector<std::string> unrated;
  bool rated = false;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const Joint& joint = joints[i];
    if (!joint.driven()) continue;
    const bool known = joint.speed_max || joint.motor_torque_max;
    rated = rated || known;
    if (!known) unrated.push_back(joint.name);
    for (const auto& [kind, rating] : {std::pair(Kind::kMotorSpeed, joint.speed_max),
                                       {Kind::kReferenceRate, joint.speed_max},
                                       {Kind::kMotorTorque, joint.motor_torque_max}})
      if (rating) set_limit(scene, limit(scene.robot, kind, i, *rating));
  }
  if (!rated) throw InputError(option + ": no drive has speed_max or motor_torque_max: there is no rating to keep");
  return unrated;
}

void validate(const Robot& robot, const BodyMotion& motion) {
  if (motion.size() != robot.joints.size())
    throw InputError(
        fmt::format("motion: {}: one for each of {} joints is needed", motion.size(), robot.joints.size()));
  for (std::size_t i = 0; i < motion.size(); ++i)
    if (robot.joints[i].driven()) validate(motion[i]);
}

TomlFile open_edited(const std::string& path, const Texts& texts) {
  const auto text = texts.find(path);
  return text == texts.end() ? TomlFile(path) : TomlFile(path, text->second);
}

bool is_of_links(const std::string& path) {
  TomlFile file(path);
  if (file.optional_text("robot") || !file.sections("load").empty()) return true;
  return require_robot(file).has("link");
}

BodyScene read_body_scene(const std::string& path, const std::vector<GivenDrive>& drives) {
  return read(path, drives, Use::kLanding);
}
BodyScene read_robot(const std::string& path, const std::vector<GivenDrive>& drives) {
  return read(path, drives, Use::kDriven);
}
BodyScene read_dropped(const std::string& path, double height, const std::vector<GivenDrive>& drives) {
  return read_edited(path, drives, height, {});
}
BodyScene read_edited_robot(const std::string& path, const Texts& texts) { return read(path, {}, Use::kDriven, texts); }
BodyScene read_edited(const std::string& path, const std::vector<GivenDrive>& drives,
                      const std::optional<double>& height, const Texts& texts) {
  if (!height) return read(path, drives, Use::kLanding, texts);
  BodyScene out = read(path, drives, Use::kDrop, texts);
  if (out.robot.base == Base::kPinned) throw InputError(Location{path}, "a pinned robot is not dropped");
  out.drop.height = *height, out.floor = true;
  out.validate();
  return out;
}

}  // namespace ukemi::landing

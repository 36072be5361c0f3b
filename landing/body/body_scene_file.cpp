#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "common/checks.hpp"
#include "common/csv.hpp"
#include "common/degrees.hpp"
#include "landing/body/robot_file.hpp"
#include "landing/model/scatter_file.hpp"
#include "landing/model/scene_file.hpp"

namespace ukemi::landing {

namespace {

constexpr double kLatest = 0.1;  ///< detection [s]

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
  drop.pitch = s.angle("pitch");
  const auto refuse = [&](const char* key, const char* why) {
    if (s.has(key)) s.fail(key, why);
  };
  if (robot.base == Base::kPinned) {
    refuse("height", "a pinned robot is not dropped"), refuse("forward_speed", "a pinned robot is not dropped");
    if (!robot.joints.empty() && robot.joints[0].child == 0)
      refuse("pitch_rate", "the pin's own joint moves the first link");
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

/// The angle of a joint in a table of joints, within their range where it has one.
void read_search(TomlSection& s, const Robot& robot, BodyScene& scene) {
  if (const auto d = s.optional_numbers("duration", 2, Range::positive())) {
    if (!((*d)[0] < (*d)[1])) s.fail("duration", "the range is empty: [low, high] with low < high is needed");
    scene.duration = {(*d)[0], (*d)[1]};
  }
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const Joint& joint = robot.joints[i];
    auto section = s.optional_section(joint.name);
    if (!section) continue;
    if (!joint.driven())
      s.fail(joint.name, std::string("the joint is ") + name(joint.kind) + ": a joint that is driven is needed");
    JointSearch& search = scene.search[i];
    if (const auto phi = section->optional_angle_pair("phi")) {
      if (!((*phi)[0] < (*phi)[1]))
        section->fail("phi_deg", "the range is empty: [low, high] with low < high is needed");
      search.phi = *phi;
    }
    search.hold = section->optional_angle("hold");
  }
}

BodyScene read(const std::string& path, const std::vector<GivenDrive>& drives, bool alone) {
  TomlFile file(path);
  BodyScene out;
  out.name = std::filesystem::path(path).stem().string();
  ContactLaw law{.stiffness = 1};  // of contacts where there is no floor
  read_floor(file, out, law);
  if (const auto name = file.optional_text("robot")) {
    out.robot_file = (std::filesystem::path(path).parent_path() / *name).string();
    TomlFile other(out.robot_file);
    read_robot_tables(other, &file, law, drives, out);
    other.finish();
  } else {
    read_robot_tables(file, nullptr, law, drives, out);
  }
  out.search.resize(out.robot.joints.size());
  if (auto drop = alone ? file.optional("drop") : file.require("drop")) read_drop(*drop, out.robot, out.drop);
  if (auto search = file.optional("search")) read_search(*search, out.robot, out);
  if (auto motion = file.optional("motion")) {
    out.freedom = read_freedom(*motion);
    out.own_durations = motion->optional_choice("duration", {"shared", "own"}) == "own";
  }
  if (auto scatter = file.optional("scatter")) out.scatter = read_scatter(*scatter);
  if (auto execution = file.optional("execution")) out.execution = read_execution(*execution);
  if (auto run = file.optional("run")) out.t_end = run->optional_number("t_end", Range::positive());
  if (auto detection = file.optional("detection")) {
    out.detection_delay = detection->optional_number("delay", Range::non_negative()).value_or(0);
    if (out.detection_delay > kLatest)
      detection->fail("delay", shortest(out.detection_delay) + " s: at most " + shortest(kLatest) + " s is needed");
  }
  file.finish();
  out.validate();
  return out;
}

}  // namespace

void BodyScene::validate() const {
  robot.validate();
  if (!(std::abs(slope) < 90 * kDegree))
    throw InputError(fmt::format("slope: {} rad: within a right angle is needed", shortest(slope)));
  check_not_negative("drop.height", drop.height), check_finite("drop.pitch", drop.pitch);
  check_finite("drop.forward_speed", drop.forward_speed), check_finite("drop.pitch_rate", drop.pitch_rate);
  if (drop.vertical_speed != 0)
    throw InputError("drop.vertical_speed: 0 is needed: a robot of links is released at rest");
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
  check_count("freedom.bumps", freedom.bumps, 0, kMostBumps), rising("freedom.bump", freedom.bump);
  if (freedom.gains) rising("freedom.gains", *freedom.gains), check_not_negative("freedom.gains", (*freedom.gains)[0]);
  rising("duration", duration), check_positive("duration", duration[0]);
}

BodyMotion held_posture(const BodyScene& scene) {
  BodyMotion out;
  for (std::size_t i = 0; i < scene.robot.joints.size(); ++i) {
    const Joint& joint = scene.robot.joints[i];
    const double phi = joint.driven() ? scene.search[i].held() : joint.phi;
    out.push_back({phi, phi, 1});
  }
  return out;
}

void validate(const Robot& robot, const BodyMotion& motion) {
  if (motion.size() != robot.joints.size())
    throw InputError(
        fmt::format("motion: {}: one for each of {} joints is needed", motion.size(), robot.joints.size()));
  for (std::size_t i = 0; i < motion.size(); ++i)
    if (robot.joints[i].driven()) validate(motion[i]);
}

bool has_links(const std::string& path) {
  TomlFile file(path);
  if (file.optional_text("robot")) return true;
  auto robot = file.optional("robot");
  return robot && robot->has("link");
}

BodyScene read_body_scene(const std::string& path, const std::vector<GivenDrive>& drives) {
  return read(path, drives, false);
}
BodyScene read_robot(const std::string& path, const std::vector<GivenDrive>& drives) {
  return read(path, drives, true);
}

}  // namespace ukemi::landing

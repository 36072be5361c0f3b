#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "common/csv.hpp"
#include "landing/body/body_scene.hpp"
#include "landing/body/places.hpp"
#include "landing/model/motion_csv.hpp"
#include "landing/model/scene_file.hpp"

namespace ukemi::landing {

BodyMotion read_body_motion(const std::string& path, const Robot& robot) {
  BodyMotion out(robot.joints.size());
  const auto for_each_driven = [&](auto&& f) {
    for (std::size_t i = 0; i < out.size(); ++i)
      if (robot.joints[i].driven()) f(robot.joints[i].name, out[i]);
  };
  if (std::filesystem::path(path).extension() == ".csv") {
    const std::vector<std::string> header = csv_header(path);
    const bool plain = sole_driven_joint(robot) && std::find(header.begin(), header.end(), "phi_ref") != header.end();
    for_each_driven([&](const std::string& joint, Motion& m) { m = read_motion_csv(path, plain ? "" : joint); });
    return out;
  }
  TomlFile file(path);
  TomlSection motions = file.require("motion");
  auto moves = file.optional("reposition");
  if (sole_driven_joint(robot) && motions.has("duration")) {
    for_each_driven([&](const std::string&, Motion& m) { m = read_motion(motions, moves); });
  } else {
    for_each_driven([&](const std::string& joint, Motion& m) {
      auto s = motions.optional_section(joint);
      if (!s) motions.fail(joint, fmt::format("a table [motion.{}] is needed: the joint is driven", joint));
      m = read_motion(*s, moves ? moves->optional_section(joint) : std::nullopt);
    });
  }
  if (auto p = file.optional("provenance")) p->accept_all();
  file.finish();
  return out;
}

std::string body_motion_toml(const BodyMotion& motion, const Robot& robot, const std::string& comments) {
  CsvWriter head;
  head.comment(comments);
  std::string text = head.text();
  for (std::size_t i = 0; i < motion.size(); ++i)
    if (robot.joints[i].driven()) text += motion_tables(motion[i], robot.joints[i].name) + "\n";
  return text;
}

namespace {

/// Column suffix and motion of a driven joint.
struct JointRows {
  std::string suffix;
  Motion motion, landing;  ///< landing: from the reference at its expected start

  Reference<double> at(double t, double start) const {
    return t < 0 ? reference_before(motion, start + t) : reference_of(landing, t);
  }
};

/// The sorted times of the rows of all joints.
std::vector<double> row_times(const std::vector<JointRows>& joints, double start, double rate) {
  std::vector<double> times;
  for (const JointRows& j : joints) {
    const MotionRows rows = rows_of(j.motion, start, rate);
    times.insert(times.end(), rows.t.begin(), rows.t.end());
  }
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

/// Comment on the clock of the rows; `air`: some have t < 0.
std::string clock_words(bool air, double start) {
  if (!air) return "t = 0 at the detected first touchdown; before it hold the first row. Units: s, rad, rad/s.";
  return fmt::format(
      "t = 0 at the detected first touchdown; before it the moves in the air, by the clock: t = 0 is then the expected "
      "detection of the touchdown, {:.6f} s after release. Hold the first row until then. The landing motions start at "
      "the detected touchdown, from where the references are. Units: s, rad, rad/s.",
      start);
}

}  // namespace

std::string body_motion_csv(const BodyMotion& motion, const Robot& robot, double rate, const std::string& comments,
                            double start) {
  const auto any = [&](auto&& of) { return std::any_of(motion.begin(), motion.end(), of); };
  const bool gains = any([](auto&m) { return m.gain_p != 1 || m.gain_d != 1; }),
             turning = any([](auto&m) { return m.release_rate() != 0; });
  std::vector<JointRows> joints;
  for (std::size_t i = 0; i < motion.size(); ++i)
    if (robot.joints[i].driven())
      joints.push_back(
          {sole_driven_joint(robot) ? "" : "_" + robot.joints[i].name, motion[i], started_at(motion[i], start)});
  const std::vector<double> times = row_times(joints, start, rate);
  const bool air = !times.empty() && times.front() < 0;
  std::vector<std::string> names = {"t"};
  if (air) names.push_back("t_from_release");
  for (const JointRows& j : joints) {
    names.insert(names.end(), {"phi_ref" + j.suffix, "dphi_ref" + j.suffix});
    if (gains) names.insert(names.end(), {"gain_p" + j.suffix, "gain_d" + j.suffix});
    if (turning) names.push_back("release_rate" + j.suffix);
  }
  CsvWriter csv;
  csv.comment(comments);
  csv.comment(clock_words(air, start));
  if (turning) csv.comment("release_rate: of a joint at release, the same in every row [rad/s].");
  csv.header(names);
  for (const double t : times) {
    csv.cell(t);
    if (air) csv.cell(start + t);
    for (const JointRows& j : joints) {
      const Reference<double> r = j.at(t, start);
      csv.cell(r.phi).cell(r.dphi);
      if (gains) csv.cell(t < 0 ? 1 : j.motion.gain_p).cell(t < 0 ? 1 : j.motion.gain_d);
      if (turning) csv.cell(j.motion.release_rate());
    }
    csv.end_row();
  }
  return csv.text();
}

}  // namespace ukemi::landing

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "common/csv.hpp"
#include "landing/body/body_scene.hpp"
#include "landing/model/motion_csv.hpp"
#include "landing/model/scene_file.hpp"

namespace ukemi::landing {

namespace {

bool alone(const Robot& robot) {
  return std::count_if(robot.joints.begin(), robot.joints.end(), [](auto& j) { return j.driven(); }) == 1;
}

}  // namespace

BodyMotion read_body_motion(const std::string& path, const Robot& robot) {
  BodyMotion out(robot.joints.size());
  const auto for_driven = [&](auto&& f) {
    for (std::size_t i = 0; i < out.size(); ++i)
      if (robot.joints[i].driven()) f(robot.joints[i].name, out[i]);
  };
  if (std::filesystem::path(path).extension() == ".csv") {
    const std::vector<std::string> header = csv_header(path);
    const bool plain = alone(robot) && std::find(header.begin(), header.end(), "phi_ref") != header.end();
    for_driven([&](const std::string& joint, Motion& m) { m = read_motion_csv(path, plain ? "" : joint); });
    return out;
  }
  TomlFile file(path);
  TomlSection motions = file.require("motion");
  auto moves = file.optional("reposition");
  if (alone(robot) && motions.has("duration")) {
    for_driven([&](const std::string&, Motion& m) { m = read_motion(motions, moves); });
  } else {
    for_driven([&](const std::string& joint, Motion& m) {
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

std::string body_motion_csv(const BodyMotion& motion, const Robot& robot, double rate, const std::string& comments) {
  std::vector<double> times;
  std::vector<std::string> names = {"t"};
  const bool gains = std::any_of(motion.begin(), motion.end(), [](auto& m) { return m.gain_p != 1 || m.gain_d != 1; });
  for (std::size_t i = 0; i < motion.size(); ++i) {
    if (!robot.joints[i].driven()) continue;
    const std::string of = alone(robot) ? "" : "_" + robot.joints[i].name;
    names.insert(names.end(), {"phi_ref" + of, "dphi_ref" + of});
    if (gains) names.insert(names.end(), {"gain_p" + of, "gain_d" + of});
    const MotionRows rows = rows_of(motion[i], std::numeric_limits<double>::infinity(), rate);
    times.insert(times.end(), rows.t.begin(), rows.t.end());
  }
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  CsvWriter csv;
  csv.comment(comments);
  csv.comment("t = 0 at the detected first touchdown; before it hold the first row. Units: s, rad, rad/s.");
  csv.header(names);
  for (const double t : times) {
    csv.cell(t);
    for (std::size_t i = 0; i < motion.size(); ++i) {
      if (!robot.joints[i].driven()) continue;
      const Reference<double> r = reference_of(motion[i], t);
      csv.cell(r.phi).cell(r.dphi);
      if (gains) csv.cell(motion[i].gain_p).cell(motion[i].gain_d);
    }
    csv.end_row();
  }
  return csv.text();
}

}  // namespace ukemi::landing

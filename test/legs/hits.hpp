// The rig of joint_simulator.hpp as a robot of one link, and its logs.
#pragma once

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "test/folder.hpp"
#include "test/joint_simulator.hpp"
#include "tools/study/robot_trials.hpp"

namespace legs {

using namespace ukemi;
using namespace ukemi::landing;
using namespace ukemi::tools;

using test::Effects;
using test::kTruth;

/// The robot's file, its drive `off` times Table 2's.
inline std::string rig_as_robot(double off) {
  return fmt::format(
      "[robot]\ngravity = 0\nbase = \"pinned\"\n[[robot.link]]\nname = \"arm\"\njoint = \"arm\"\nmass = 0.806\n"
      "inertia_com = 0.00609\ncom = [0.15, 0]\n[[robot.push]]\nname = \"hit\"\nlink = \"arm\"\nat = [0.3, 0]\n"
      "[drive.arm]\nk_p = {}\nk_d = {}\nk_sea = {}\nc_sea = {}\ni_motor = {}\ntau_max = 20\n",
      kTruth[0] * off, kTruth[1] / off, kTruth[2] * off, kTruth[3] / off, kTruth[4] * off);
}

struct Hits {
  test::Folder folder;
  DrivenRobot robot;
  std::vector<RobotTrial> trials;
  RobotFitOptions options;

  Hits(const std::vector<identify::Trial>& logs, double off) {
    robot = read_driven_robot(folder.write("robot.toml", rig_as_robot(off)));
    for (const identify::Trial& hit : logs) {
      std::string log = "t,phi_arm,phi_ref_arm,push_hit_x\n";
      for (std::size_t i = 0; i < hit.t.size(); ++i)
        log += fmt::format("{},{:.12g},0,{:.12g}\n", hit.t[i], hit.phi[i], hit.force[i]);
      trials.push_back(
          read_robot_trials(folder.write(hit.file + ".csv", log), robot.scene.robot, {.columns = ""}).front());
    }
    options.terms = robot_terms(robot, trials);
    options.terms.free = {"drive.arm.k_p", "drive.arm.k_d", "drive.arm.k_sea", "drive.arm.c_sea", "drive.arm.i_motor"};
    options.threads = 2;
  }
  SeaParameters<double>& sea() { return robot.scene.robot.joints[0].sea; }
};

inline const identify::Estimate& found(const RobotFit& fit, const std::string& name) {
  const identify::Estimate* e = identify::find_constant(fit, name);
  REQUIRE(e);
  REQUIRE(e->std);
  return *e;
}
/// By how many of their errors the five constants are off at most.
inline double worst(const RobotFit& fit) {
  double out = 0;
  for (std::size_t k = 0; k < kConstants; ++k) {
    const identify::Estimate& e = found(fit, std::string("drive.arm.") + kConstantNames[k]);
    out = std::max(out, std::abs(e.value - kTruth[k]) / *e.std);
  }
  return out;
}

}  // namespace legs

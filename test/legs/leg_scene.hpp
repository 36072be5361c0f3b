// A robot of any joints, its floor, its drop, and what it plays; and the files of both.
#pragma once

#include "landing/model/motion.hpp"
#include "landing/model/scene.hpp"
#include "test/legs/robot.hpp"

namespace ukemi::landing {

struct LegScene {
  std::string name;
  Robot robot;
  double slope = 0;  ///< the floor rises forward by so much [rad]
  bool floor = false;
  Drop drop;  ///< height: of the lowest contact's surface; pitch: theta of the first link
  double detection_delay = 0;
  std::optional<double> t_end;  ///< [s]
};

/// What each joint of Robot::joints plays; of those that are not driven, nothing.
using LegMotion = std::vector<Motion>;

/// Reads a scene whose robot is in the long form. Throws InputError.
LegScene read_leg_scene(const std::string& path);
/// Reads [motion.JOINT] and [reposition.JOINT]. Throws InputError.
LegMotion read_leg_motion(const std::string& path, const Robot& robot);

}  // namespace ukemi::landing

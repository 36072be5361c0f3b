// Exports of results for other programs: ROS 2, PlotJuggler, MuJoCo, Gazebo.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "landing/judge/checked.hpp"
#include "landing/plan/checked_body.hpp"
#include "tools/program/output.hpp"
#include "tools/report/actuator_models.hpp"

namespace ukemi::tools {

/// The requested exports.
struct Exports {
  enum class Format {
    kRos2,         ///< trajectory_msgs/JointTrajectory, YAML
    kPlotJuggler,  ///< the landing's rows without comment lines
    kMjcf,         ///< the actuator as a model of MuJoCo
    kUrdf,         ///< the actuator as URDF
  };
  std::vector<Format> formats;
  std::optional<std::string> joint;  ///< name in the files; absent: knee, or the joint's own of a robot of links

  bool has(Format format) const;
};

/// Files of an actuator by name: its rig as a model.
std::map<std::string, std::string> exported(const Exports& exports, const Actuator& actuator, const RigLink& link,
                                            const Run& run);
/// Files of a motion and its landing by name. `start`: expected start of the landing motion, from release [s], as in
/// landing::rows_of. Without a trajectory there is no file for PlotJuggler.
std::map<std::string, std::string> exported(const Exports& exports, const landing::Motion& motion, double start,
                                            const landing::Landing& landing, const Run& run);
/// Files of a robot of links, whose landing motions start at expected_start().
std::map<std::string, std::string> exported(const Exports& exports, const landing::BodyScene& scene,
                                            const landing::BodyMotion& motion, const landing::BodyLanding& landing,
                                            const Run& run);

}  // namespace ukemi::tools

// Results as other programs read them, beside a verb's own files.
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

/// What is asked for.
struct Exports {
  enum class Format {
    kRos2,         ///< trajectory_msgs/JointTrajectory, YAML
    kPlotJuggler,  ///< the landing's rows without comment lines
    kMjcf,         ///< the actuator as a model of MuJoCo
    kUrdf,         ///< the same as URDF
  };
  std::vector<Format> formats;
  std::optional<std::string> joint;  ///< its name in the files; absent: knee, of a robot of links its own

  bool has(Format format) const;
};

/// The files of an actuator, by their names: its rig as a model.
std::map<std::string, std::string> exported(const Exports& exports, const Actuator& actuator, const RigLink& link,
                                            const Run& run);
/// The files of a motion and its landing, by their names. `start`: when the landing motion is expected to start, from
/// release, as landing::rows_of has it. Without a trajectory there is no file for PlotJuggler.
std::map<std::string, std::string> exported(const Exports& exports, const landing::Motion& motion, double start,
                                            const landing::Landing& landing, const Run& run);
/// The same of a robot of links, whose landing motions start as expected_start says.
std::map<std::string, std::string> exported(const Exports& exports, const landing::BodyScene& scene,
                                            const landing::BodyMotion& motion, const landing::BodyLanding& landing,
                                            const Run& run);

}  // namespace ukemi::tools

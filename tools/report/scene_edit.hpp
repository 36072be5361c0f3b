// Edits the files of a robot of links: --set KEY=VALUE.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/toml_edit.hpp"
#include "landing/body/body_scene.hpp"
#include "landing/body/robot_file.hpp"

namespace ukemi::tools {

/// A scene's file, or a robot's alone, and the robot's file that it names, with edits. What is not set stays.
class SceneEdit {
 public:
  /// `scene`: as read from `path`.
  SceneEdit(const std::string& path, const landing::BodyScene& scene);

  /// KEY=VALUE: a number of landing::design_names, in the unit of the files; or search.JOINT.hold_deg, and ranges
  /// LO:HI of search.JOINT.phi_deg, joint.JOINT.phi_deg, stop.JOINT.phi_deg and search.duration. Throws InputError
  /// where there is no such number, or the file's notation is not supported. Ranges are checked where the texts are
  /// read.
  void set(const std::string& assignment);

  landing::Texts texts() const;
  /// Contents of set_scene.toml and, where the robot's file changed, of set_robot.toml, by name. `height`: of the drop,
  /// if given [m]. Paths are relative to `folder`; `comments` come first; `drives`: of --actuator.
  std::map<std::string, std::string> kept(const std::optional<double>& height, const std::string& comments,
                                          const std::string& folder,
                                          const std::vector<landing::GivenDrive>& drives) const;

 private:
  void set_number(const std::string& name, double value);
  void write_lengths(const landing::BodyScene& before);
  void set_joint_value(const std::string& name, const std::string& value);
  void set_stop(const std::string& name, const std::string& value);
  TomlEdit& robot_file() { return robot_ ? *robot_ : file_; }
  const TomlEdit& robot_file() const { return robot_ ? *robot_ : file_; }

  landing::BodyScene scene_;       ///< with the edits
  TomlEdit file_;                  ///< the given one
  std::optional<TomlEdit> robot_;  ///< the robot's, where it has its own
  std::string robot_before_;
  std::set<std::string> set_;  ///< keys set so far
};

}  // namespace ukemi::tools

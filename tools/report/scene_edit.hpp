// The files of a robot of links with other numbers: --set KEY=VALUE.
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

/// A scene's file, or a robot's alone, and the robot's file that it names, under edits. What is not set stays as it is
/// written.
class SceneEdit {
 public:
  /// `scene` is what the file holds.
  SceneEdit(const std::string& path, const landing::BodyScene& scene);

  /// KEY=VALUE: a number of landing::design_names, in the unit of the files; or search.JOINT.hold_deg, and ranges
  /// LO:HI of search.JOINT.phi_deg, joint.JOINT.phi_deg, stop.JOINT.phi_deg and search.duration. Throws InputError
  /// where there is no such number, or the file is written in a way that cannot be followed; its range is that of who
  /// reads the texts.
  void set(const std::string& assignment);

  landing::Texts texts() const;
  /// As one file that falls from `height`, where one is given, or two: set_scene.toml and, where the robot's file
  /// changed, set_robot.toml. Paths count from `folder`; `comments` go in front; `drives` are those given beside the
  /// files'.
  std::map<std::string, std::string> kept(const std::optional<double>& height, const std::string& comments,
                                          const std::string& folder,
                                          const std::vector<landing::GivenDrive>& drives) const;

 private:
  void set_number(const std::string& name, double value);
  void write_lengths(const landing::BodyScene& was);
  void set_of_joint(const std::string& name, const std::string& value);
  void set_stop(const std::string& name, const std::string& value);
  TomlEdit& robot_file() { return apart_ ? *apart_ : file_; }
  const TomlEdit& robot_file() const { return apart_ ? *apart_ : file_; }

  landing::BodyScene scene_;       ///< with what is set
  TomlEdit file_;                  ///< the one that is given
  std::optional<TomlEdit> apart_;  ///< the robot's own
  std::string apart_before_;
  std::set<std::string> set_;  ///< keys so far
};

}  // namespace ukemi::tools

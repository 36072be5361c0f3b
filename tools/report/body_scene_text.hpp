// A scene of a robot of links with other constants of its floor, as files: what was read, with these values.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/toml_edit.hpp"
#include "landing/body/body_scene.hpp"

namespace ukemi::tools {

/// Paths of drives, which count from the file's folder, from another one.
void move_drives(const landing::Robot& robot, const std::string& path, const std::string& folder, TomlEdit& file);

/// Writes the law of a contact into its table, what it has of a [floor] too.
void write_own_law(const landing::ContactPoint& contact, TomlEdit& file, const TomlEdit::Place& table);

/// A path as it is from a folder, which need not be there yet.
std::string from_folder(const std::string& path, const std::string& folder);
/// Tables of drives that were given beside the files'. Throws InputError for a drive of a joint that has one there.
std::string drive_tables(const landing::BodyScene& scene, const std::vector<landing::GivenDrive>& drives,
                         const TomlEdit& file, const TomlEdit& robot, const std::string& folder);

/// The files scene.toml and, where contacts that stand in the robot's own file change, robot.toml, for `folder`. `path`
/// is the scene's file; `scene` was read from it, and has other contact laws, pads, pitch, uncertainty or verdicts, or
/// limits of joints and contacts beside those of the file.
/// What stands in the file and is as before is left as it is written, paths are made relative to the folder;
/// `comments` go in front. `drives`: those that the scene was read with beside its own. Throws InputError where the
/// file is written in a way that cannot be followed, and for a drive of a joint that has one in the files.
std::map<std::string, std::string> scene_files(const std::string& path, const landing::BodyScene& scene,
                                               const std::string& comments, const std::string& folder,
                                               const std::vector<landing::GivenDrive>& drives = {});

}  // namespace ukemi::tools

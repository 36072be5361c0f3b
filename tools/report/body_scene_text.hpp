// Writes the files of a scene of a robot of links with changed constants; what is not changed keeps its text.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/toml_edit.hpp"
#include "landing/body/body_scene.hpp"

namespace ukemi::tools {

/// Makes paths of drive files in `file`, relative to the folder of `path`, relative to `folder`.
void rebase_drives(const landing::Robot& robot, const std::string& path, const std::string& folder, TomlEdit& file);

/// Writes all constants of a contact's law into its own table, those that it has from [floor] too.
void write_contact_law(const landing::ContactPoint& contact, TomlEdit& file, const TomlEdit::Place& table);

/// `path` relative to a folder, which need not exist yet.
std::string relative_to(const std::string& path, const std::string& folder);
/// Tables [drive.JOINT] of --actuator. Throws InputError where a file has a drive of the joint.
std::string drive_tables(const landing::BodyScene& scene, const std::vector<landing::GivenDrive>& drives,
                         const TomlEdit& file, const TomlEdit& robot, const std::string& folder);

/// Contents of scene.toml and, where contacts in the robot's own file change, of robot.toml, by name. `path` is the
/// scene's file; `scene` was read from it and may differ in contact laws, pads, pitch, uncertainty, verdicts, and in
/// additional limits of joints and contacts. Unchanged text stays, paths become relative to `folder`, `comments` come
/// first. `drives`: of --actuator. Throws InputError where the file's notation is not supported, or where a file has a
/// drive of the joint.
std::map<std::string, std::string> scene_files(const std::string& path, const landing::BodyScene& scene,
                                               const std::string& comments, const std::string& folder,
                                               const std::vector<landing::GivenDrive>& drives = {});

}  // namespace ukemi::tools

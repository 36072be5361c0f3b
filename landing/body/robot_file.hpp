// Reads a robot's tables, from its own file or from a scene file.
#pragma once

#include <map>

#include "common/actuator.hpp"
#include "common/toml.hpp"
#include "landing/body/body_scene.hpp"
#include "landing/model/scene_file.hpp"

namespace ukemi::landing {

/// Whether a file needs a robot of links: it has [[robot.link]], robot = "FILE" or [[load]].
bool is_of_links(const std::string& path);

/// Contents that replace those of files, by path.
using Texts = std::map<std::string, std::string>;
/// As read_body_scene, with a height as read_dropped; read_edited_robot: as read_robot.
BodyScene read_edited(const std::string& path, const std::vector<GivenDrive>& drives,
                      const std::optional<double>& height, const Texts& texts);
BodyScene read_edited_robot(const std::string& path, const Texts& texts);
TomlFile open_edited(const std::string& path, const Texts& texts);

/// Reads a contact law of [floor] or of a contact; `floor`: defaults of a contact, absent for [floor].
ContactLaw read_law(TomlSection& section, const std::optional<ContactLaw>& floor);

/// Whether a geared drive has this constant of an actuator.
bool is_geared_constant(const std::string& key);
/// Gives a joint the elastic drive of an actuator file. Throws InputError for one without controller gains.
void set_elastic(const Actuator& actuator, Joint& joint, const Location& where);

/// Reads the robot and its drive files from [robot] of a file, and [drive] of that file or of `scene` (may be null).
void read_robot_tables(TomlFile& file, TomlFile* scene, const ContactLaw& floor, const std::vector<GivenDrive>& drives,
                       BodyScene& out);

/// Throws InputError if a contact has a stiffness neither of its own nor from [floor].
void require_contact_stiffness(const BodyScene& scene, const std::string& path);
/// Turns the floor on if all contacts, or with kAllOrNone any, have a stiffness. Throws InputError if one is missing.
enum class Contacts { kAll, kAllOrNone };
void enable_floor(const std::string& path, Contacts needed, BodyScene& scene);

}  // namespace ukemi::landing

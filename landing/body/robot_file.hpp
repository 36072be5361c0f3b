// A robot's tables, in a file of its own or in a scene's.
#pragma once

#include <map>

#include "common/actuator.hpp"
#include "common/toml.hpp"
#include "landing/body/body_scene.hpp"
#include "landing/model/scene_file.hpp"

namespace ukemi::landing {

/// Whether a file asks for a robot of links: [[robot.link]], robot = "FILE", or loads, of which the paper's two links
/// know none.
bool is_of_links(const std::string& path);

/// Texts that stand in place of files, by their paths.
using Texts = std::map<std::string, std::string>;
/// As read_body_scene or, with a height, as read_dropped; and as read_robot.
BodyScene read_edited(const std::string& path, const std::vector<GivenDrive>& drives,
                      const std::optional<double>& height, const Texts& texts);
BodyScene read_edited_robot(const std::string& path, const Texts& texts);
TomlFile open_edited(const std::string& path, const Texts& texts);

/// Constants of the floor's law, the same keys in [floor] and in a contact; `floor` holds what stands where a contact
/// omits one, absent for [floor] itself.
ContactLaw read_law(TomlSection& section, const std::optional<ContactLaw>& floor);

/// The paper's robot by its links: thigh and shank, joined by the knee, which has no drive yet; the points that may
/// touch have their names, and all of them this law.
Robot by_links(const TwoLinkTable& table, const ContactLaw& law);

/// Whether a geared drive has that constant of an actuator.
bool is_of_geared(const std::string& key);
/// An elastic drive, as a file holds it. Throws InputError for one without the gains of its controller.
void set_elastic(const Actuator& actuator, Joint& joint, const Location& where);

/// The robot, of [robot] of a file and [drive] of that file or of the scene that names it (null: there is none), and
/// the drives' files.
void read_robot_tables(TomlFile& file, TomlFile* scene, const ContactLaw& floor, const std::vector<GivenDrive>& drives,
                       BodyScene& out);

/// Throws InputError where a contact has no stiffness, its own or a [floor]'s.
void check_stiff_contacts(const BodyScene& scene, const std::string& path);
/// Without [floor] contacts touch by their own laws: all of them or, where so many may, none. Throws InputError where
/// some have no stiffness.
enum class Contacts { kAll, kAllOrNone };
void stand_on_contacts(const std::string& path, Contacts needed, BodyScene& scene);

}  // namespace ukemi::landing

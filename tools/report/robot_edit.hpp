// Sets numbers of a robot's file by dotted names: drive.knee.k_sea.
#pragma once

#include <string>
#include <vector>

#include "common/toml_edit.hpp"

namespace ukemi::tools {

/// A name split at its dots.
std::vector<std::string> split_name(const std::string& name);
/// Index in [[list]] of the table with that `name`. Throws InputError where there is none.
std::string index_of(const TomlEdit& file, const TomlEdit::Place& list, const std::string& name);
/// Sets a number; a key in degrees, KEY_deg, replaces KEY.
void set_key(TomlEdit& file, const TomlEdit::Place& table, const std::string& key, double value);
/// Sets element `which`, 0 or 1, of an array of two numbers; in a new array the other one is 0.
void set_element(TomlEdit& file, const TomlEdit::Place& table, const std::string& key, std::size_t which, double value);
/// Writes drive.JOINT.KEY, robot.link.LINK.KEY, robot.contact.CONTACT.KEY, stop.JOINT.KEY, robot.rail.KEY or
/// robot.KEY. Throws InputError where the file's notation is not supported, or a drive has a file of its own.
void set_number(TomlEdit& file, const std::string& name, double value);

}  // namespace ukemi::tools

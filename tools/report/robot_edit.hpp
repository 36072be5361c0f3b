// Numbers of a robot's file, written by their names.
#pragma once

#include <string>
#include <vector>

#include "common/toml_edit.hpp"

namespace ukemi::tools {

/// A name at its dots.
std::vector<std::string> parts_of(const std::string& name);
/// Which of the tables in [[ ]] has that name. Throws InputError where none has.
std::string index_of(const TomlEdit& file, const TomlEdit::Place& list, const std::string& name);
/// A number at a key, or at a key of another unit of it: KEY_deg in place of KEY.
void set_key(TomlEdit& file, const TomlEdit::Place& table, const std::string& key, double value);
/// One of two numbers [first, second]; where they are not there yet the other is 0.
void set_of_pair(TomlEdit& file, const TomlEdit::Place& table, const std::string& key, std::size_t which, double value);
/// Writes drive.JOINT.KEY, robot.link.LINK.KEY, robot.contact.CONTACT.KEY, stop.JOINT.KEY, robot.rail.KEY or
/// robot.KEY; of a place or an end the other number stays. Throws InputError where the file is written in a way that
/// cannot be followed, or a drive stands in a file of its own.
void set_number(TomlEdit& file, const std::string& name, double value);

}  // namespace ukemi::tools

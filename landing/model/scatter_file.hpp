// Scatter as a table of a scene file, and as the text of an option.
#pragma once

#include <string>

#include "common/toml.hpp"
#include "landing/model/scatter.hpp"
#include "landing/model/scene.hpp"

namespace ukemi::landing {

/// [scatter]: pitch_deg, height, forward_speed, pitch_rate_deg, phi_deg, rate_deg, delay are standard deviations;
/// stiffness, damping_normal, damping_tangential texts as "10%"; absent: 0. Throws InputError with file:line:column.
Scatter read_scatter(TomlSection& section, bool of_links);
/// Reads [execution] phi_deg, duration. Throws InputError with file:line:column.
ExecutionTolerance read_execution(TomlSection& section);
/// The lines of [scatter] in a file.
std::string toml_lines(const Scatter& scatter);

/// Parses NAME=VALUE,... with the names of [scatter], without quotes. Throws InputError "OPTION: ...".
Scatter parse_scatter(const std::string& option, const std::string& text);
/// The text that parse_scatter reads back.
std::string text_of(const Scatter& scatter);

}  // namespace ukemi::landing

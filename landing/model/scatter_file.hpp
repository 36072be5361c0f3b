// A scatter as a table of a scene file, and as the text of an option.
#pragma once

#include <string>

#include "common/toml.hpp"
#include "landing/model/scatter.hpp"
#include "landing/model/scene.hpp"

namespace ukemi::landing {

/// [scatter]: pitch_deg, height, forward_speed, pitch_rate_deg, phi_deg, rate_deg, delay are standard deviations;
/// stiffness, damping_normal, damping_tangential are texts as "10%". What is absent does not scatter. Throws InputError
/// with file:line:column.
Scatter read_scatter(TomlSection& section, bool of_links);
/// [execution]: phi_deg, duration. Throws InputError with file:line:column.
ExecutionTolerance read_execution(TomlSection& section);
/// The scatter's lines in a file.
std::string toml_lines(const Scatter& scatter);

/// NAME=VALUE,... with the names of [scatter] and without quotes. Throws InputError "OPTION: ...".
Scatter parse_scatter(const std::string& option, const std::string& text);
/// The text that parse_scatter reads back.
std::string text_of(const Scatter& scatter);

}  // namespace ukemi::landing

// Headings of a verb's --help: what an option is about, told once for all verbs.
#pragma once

#include <CLI/CLI.hpp>

namespace ukemi::tools {

/// Gives every option of the verbs its heading, in one order. An option that no heading has stays under "Options", as
/// --help does. Call once all verbs have their options.
void group_options(CLI::App& app);

}  // namespace ukemi::tools
